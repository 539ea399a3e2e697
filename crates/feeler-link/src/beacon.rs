//! Says ten times a second that a program is there, and how it does.

use super::endpoints::LinkError;
use super::message::{Heartbeat, PROTOCOL};
use super::outlet::{Outlet, send};
use super::shared::Shared;
use super::topic::{Place, Topic};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Time between two heartbeats.
const INTERVAL: Duration = Duration::from_millis(100);

/// Sends heartbeats from a thread of its own for as long as it lives, so that a program that works hard is
/// not taken for a silent one.
pub struct Beacon {
    status: Shared<Status>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct Status {
    heartbeat: Heartbeat,
    /// Whether to send the next one at once.
    now: bool,
    /// Whether to send none.
    is_silent: bool,
    stopped: bool,
}

impl Beacon {
    /// Starts with a first heartbeat; protocol, version and number are filled in.
    ///
    /// # Errors
    /// When the first cannot be sent, or there is no thread to be had.
    pub fn start(outlet: Arc<dyn Outlet>, mut heartbeat: Heartbeat) -> Result<Self, LinkError> {
        heartbeat.protocol = PROTOCOL;
        heartbeat.version = env!("CARGO_PKG_VERSION").into();
        let status = Shared::new(Status {
            heartbeat,
            ..Status::default()
        });
        beat(&*outlet, &status)?;
        let shared = status.clone();
        let work = move || {
            loop {
                shared.wait_for(INTERVAL, |status| status.now || status.stopped);
                // A link that is closed ends the program elsewhere, with its reason.
                if shared.lock().stopped || beat(&*outlet, &shared).is_err() {
                    return;
                }
            }
        };
        let thread = thread::Builder::new().name("heartbeat".into()).spawn(work);
        Ok(Self {
            status,
            thread: Some(thread.map_err(|e| LinkError::Transport(e.to_string()))?),
        })
    }

    /// Changes what the next heartbeats say.
    pub fn update(&self, change: impl FnOnce(&mut Heartbeat)) {
        change(&mut self.status.lock().heartbeat);
    }

    /// Sends no heartbeats while `is_silent`: the program leaves its place to another.
    pub fn set_silent(&self, is_silent: bool) {
        self.status.lock().is_silent = is_silent;
    }

    /// Sends a heartbeat at once: somebody new is there.
    pub fn greet(&self) {
        self.status.lock().now = true;
        self.status.changed();
    }
}

fn beat(outlet: &dyn Outlet, status: &Shared<Status>) -> Result<(), LinkError> {
    let heartbeat = {
        let mut status = status.lock();
        status.now = false;
        if status.is_silent {
            return Ok(());
        }
        status.heartbeat.sequence += 1;
        status.heartbeat.clone()
    };
    // Who has no place in a rig is there to give it an order at most.
    let place = heartbeat.place().unwrap_or(Place::Order);
    send(outlet, Topic::Heartbeat(place), &heartbeat)
}

impl Drop for Beacon {
    fn drop(&mut self) {
        self.status.lock().stopped = true;
        self.status.changed();
        // A thread that panicked has nothing left to say.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}
