//! Periodic heartbeats of a program.

use crate::messages::message::{Heartbeat, PROTOCOL};
use crate::transport::endpoints::LinkError;
use crate::transport::outlet::{Outlet, send};
use crate::transport::shared::Shared;
use crate::transport::topic::{ProgramRole, Topic};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Interval between heartbeats.
const INTERVAL: Duration = Duration::from_millis(100);

/// Sends heartbeats ten times per second from a background thread until dropped, so that a busy program does not
/// appear dead.
pub struct Beacon {
    status: Shared<Status>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct Status {
    heartbeat: Heartbeat,
    /// Send the next heartbeat at once.
    now: bool,
    /// Send no heartbeats.
    is_silent: bool,
    stopped: bool,
}

impl Beacon {
    /// Sends a first heartbeat and starts the thread. Protocol, version and sequence number are filled in.
    ///
    /// # Errors
    /// If the first heartbeat cannot be sent, or the thread cannot be started.
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
                // A closed link is reported by the program's main loop.
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

    /// Changes the content of the following heartbeats.
    pub fn update(&self, change: impl FnOnce(&mut Heartbeat)) {
        change(&mut self.status.lock().heartbeat);
    }

    /// Suppresses heartbeats while `is_silent`, so that another program can have this program's role.
    pub fn set_silent(&self, is_silent: bool) {
        self.status.lock().is_silent = is_silent;
    }

    /// Sends a heartbeat at once, to introduce this program to a new one.
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
    // A program without a place in the rig can at most send an order.
    let place = heartbeat.place().unwrap_or(ProgramRole::Order);
    send(outlet, Topic::Heartbeat(place), &heartbeat)
}

impl Drop for Beacon {
    fn drop(&mut self) {
        self.status.lock().stopped = true;
        self.status.changed();
        // A panic of the thread is ignored.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}
