//! Sends a robot's joint velocities on a background thread, because publishing with Zenoh allocates and may block.

use crate::freshness::lock;
use crate::message::Float64MultiArray;
use crate::publisher::Publisher;
use std::io;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Background sender of joint velocities. Sends the latest velocities. Sends zeros if these have expired, if no new
/// ones are set for too long, and when dropped.
pub(crate) struct VelocitySender {
    waiting: Arc<Waiting>,
    thread: Option<JoinHandle<()>>,
}

struct Waiting {
    velocities: Mutex<Velocities>,
    changed: Condvar,
}

/// Velocities to send, shared with the thread.
struct Velocities {
    values: Vec<f64>,
    /// Time at which `values` expire, or `None` if they have been sent.
    until: Option<Instant>,
    /// Error of the last attempt to send.
    failed: Option<String>,
    is_over: bool,
}

impl VelocitySender {
    /// Starts a thread that publishes messages of `joints` velocities. It publishes zeros if none are set for longer
    /// than `most`.
    ///
    /// # Errors
    /// If the thread could not be started.
    pub fn start(
        publisher: Publisher<Float64MultiArray>,
        joints: usize,
        most: Duration,
    ) -> io::Result<Self> {
        let waiting = Arc::new(Waiting {
            velocities: Mutex::new(Velocities {
                values: vec![0.0; joints],
                until: None,
                failed: None,
                is_over: false,
            }),
            changed: Condvar::new(),
        });
        let theirs = Arc::clone(&waiting);
        let thread = thread::Builder::new().name("velocities".into());
        let thread = thread.spawn(move || theirs.send_all(publisher, joints, most))?;
        Ok(Self {
            waiting,
            thread: Some(thread),
        })
    }

    /// Sets the velocities (rad/s or m/s) to send next, which expire at `until`. Neither blocks nor allocates.
    ///
    /// # Errors
    /// If sending earlier velocities failed. The new ones are sent nevertheless.
    pub fn give(
        &self,
        velocities: impl Iterator<Item = f64>,
        until: Instant,
    ) -> Result<(), String> {
        let mut waiting = lock(&self.waiting.velocities);
        for (value, velocity) in waiting.values.iter_mut().zip(velocities) {
            *value = velocity;
        }
        waiting.until = Some(until);
        let failed = waiting.failed.take();
        drop(waiting);
        self.waiting.changed.notify_one();
        failed.map_or(Ok(()), Err)
    }
}

impl Drop for VelocitySender {
    fn drop(&mut self) {
        lock(&self.waiting.velocities).is_over = true;
        self.waiting.changed.notify_one();
        // The thread ends after sending zeros. If it panicked, nothing more can be done.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl Waiting {
    /// Sends velocities until the sender is dropped, then zeros.
    fn send_all(&self, mut publisher: Publisher<Float64MultiArray>, joints: usize, most: Duration) {
        let mut message = Float64MultiArray {
            data: vec![0.0; joints],
            ..Float64MultiArray::default()
        };
        let mut moves = false;
        loop {
            let is_over = self.next(&mut message.data, moves.then_some(most));
            moves = message.data.iter().any(|velocity| *velocity != 0.0);
            if let Err(error) = publisher.publish(&message) {
                lock(&self.velocities).failed = Some(error.to_string());
            }
            if is_over {
                return;
            }
        }
    }

    /// Waits for new velocities, for at most `longest` if given, and writes them to `next`. Writes zeros on timeout, if
    /// they have expired, or if the sender was dropped. Returns `true` if it was dropped.
    fn next(&self, next: &mut [f64], longest: Option<Duration>) -> bool {
        let is_idle = |waiting: &mut Velocities| waiting.until.is_none() && !waiting.is_over;
        let waiting = lock(&self.velocities);
        let mut waiting = match longest {
            None => self.changed.wait_while(waiting, is_idle),
            Some(longest) => {
                let waited = self.changed.wait_timeout_while(waiting, longest, is_idle);
                waited
                    .map(|(waiting, _)| waiting)
                    .map_err(|e| PoisonError::new(e.into_inner().0))
            }
        }
        .unwrap_or_else(PoisonError::into_inner);
        let until = waiting.until.take();
        match until.is_some_and(|until| Instant::now() <= until) && !waiting.is_over {
            true => next.copy_from_slice(&waiting.values),
            false => next.fill(0.0),
        }
        waiting.is_over
    }
}
