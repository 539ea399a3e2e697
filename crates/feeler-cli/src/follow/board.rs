//! Latest readings of a hand, shared between its control loop and the thread that answers requests.

use feeler::control::task::follow::Requests;
use feeler::control::{ControlLoop, FingerFlags, Phase, TactileSource};
use feeler::hand::{Hand, JointState, JointVector};
use glam::DVec3;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Readings of a finger.
#[derive(Debug, Clone, Default)]
pub struct FingerSnapshot {
    pub joints: JointState,
    /// Joint velocities as sent to the drives (rad/s or m/s).
    pub command: JointVector,
    pub forces: Vec<DVec3>,
    pub flags: FingerFlags,
    /// Time of the forces (s).
    pub sensed_at: f64,
}

/// Readings of the hand after a control step.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Time of the control step (s).
    pub time: f64,
    /// Instant at which the time last changed.
    pub changed: Instant,
    pub phase: Phase,
    /// Reason of the stop, if the hand is stopped.
    pub stopped: Option<String>,
    /// Number of the latest request whose velocities were commanded.
    pub followed: u64,
    pub fingers: Vec<FingerSnapshot>,
}

/// Latest snapshot, or `None` before the first control step.
#[derive(Debug, Default)]
pub struct Board {
    latest: Mutex<Option<Snapshot>>,
    stepped: Condvar,
}

impl Board {
    /// Stores the readings of the latest step and the number of the latest executed request.
    pub fn update<S: TactileSource, H: Hand>(
        &self,
        control_loop: &ControlLoop<S, H>,
        requests: &Requests,
    ) {
        let controller = control_loop.controller();
        let time = control_loop.state().stamp;
        let mut latest = self.lock();
        let snapshot = latest.get_or_insert_with(|| Snapshot {
            time: f64::NAN,
            changed: Instant::now(),
            phase: Phase::Search,
            stopped: None,
            followed: 0,
            fingers: vec![FingerSnapshot::default(); controller.fingers().len()],
        });
        if snapshot.time != time {
            (snapshot.time, snapshot.changed) = (time, Instant::now());
        }
        snapshot.phase = controller.phase();
        if snapshot.stopped.is_some() != controller.stop_reason().is_some() {
            snapshot.stopped = controller.stop_reason().map(ToString::to_string);
        }
        snapshot.followed = requests.followed();
        let fingers = controller.fingers().iter().zip(control_loop.touches());
        let fingers = fingers.zip(&control_loop.state().joints);
        for (own, ((finger, touch), &joints)) in snapshot.fingers.iter_mut().zip(fingers) {
            own.joints = joints;
            let count = finger.geometry().joint_count();
            own.command = finger.admitted.joint_velocity.padded(count);
            own.forces.clone_from(&touch.frame.forces);
            (own.flags, own.sensed_at) = (touch.flags, touch.stamp);
        }
        drop(latest);
        self.stepped.notify_all();
    }

    /// Latest snapshot.
    pub fn latest(&self) -> Option<Snapshot> {
        self.lock().clone()
    }

    /// Waits until request `number` is executed, the hand is stopped, or `longest` is over. Returns the latest
    /// snapshot.
    pub fn wait_for(&self, number: u64, longest: Duration) -> Option<Snapshot> {
        let is_pending = |latest: &mut Option<Snapshot>| match latest {
            Some(snapshot) => snapshot.followed < number && snapshot.stopped.is_none(),
            None => false,
        };
        let waited = self
            .stepped
            .wait_timeout_while(self.lock(), longest, is_pending);
        let (latest, _) = waited.unwrap_or_else(PoisonError::into_inner);
        latest.clone()
    }

    fn lock(&self) -> MutexGuard<'_, Option<Snapshot>> {
        self.latest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
