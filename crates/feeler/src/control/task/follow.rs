//! Task controlled by another program: each finger follows the joint velocities of the latest request.

use super::Task;
use crate::control::phase::Phase;
use crate::control::plan::Plan;
use crate::control::sense::HandReadings;
use crate::control::stop_reason::StopReason;
use crate::hand::{FingerGeometry, JointVector, MAX_FINGERS, jacobian};
use std::sync::{Arc, Mutex, PoisonError};

/// Joint velocities of all fingers (rad/s, or m/s of a prismatic joint).
pub type HandVelocities = [JointVector; MAX_FINGERS];

/// Joint velocities requested from a [`FollowTask`] by another thread. Clones share the request.
#[derive(Debug, Clone, Default)]
pub struct Requests(Arc<Mutex<Request>>);

#[derive(Debug, Clone, Copy, Default)]
struct Request {
    velocities: HandVelocities,
    /// Number of this request, from 1; 0 before the first request.
    number: u64,
    /// Number of the request that the latest control step has followed.
    followed: u64,
    has_ended: bool,
}

impl Requests {
    /// Replaces the requested velocities and returns the number of the request, from 1.
    pub fn request(&self, velocities: HandVelocities) -> u64 {
        let mut request = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        request.velocities = velocities;
        request.number += 1;
        request.number
    }

    /// Ends the task at its next control step.
    pub fn end(&self) {
        let mut request = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        request.has_ended = true;
    }

    /// Number of the request that the latest control step has followed; 0 if none has been followed.
    pub fn followed(&self) -> u64 {
        let request = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        request.followed
    }

    /// Returns the latest request and marks it as followed by the current control step.
    fn follow(&self) -> Request {
        let mut request = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        request.followed = request.number;
        *request
    }
}

/// Follows requested joint velocities. A request expires if no new one arrives; the fingers then stand still. A request
/// that arrives while the hand is stopped is not followed after the hand resumes. The phase is [`Phase::Move`] until
/// the requests end.
#[derive(Debug, Clone)]
pub struct FollowTask {
    requests: Requests,
    fingers: Vec<FingerGeometry>,
    /// Duration after which a request expires (s).
    lifetime: f64,
    /// Request that is followed.
    followed: Request,
    /// Time of the control step at which the request arrived (s).
    arrived: f64,
    /// Time of the previous control step of the task (s), which is not called while the hand is stopped.
    stepped: f64,
    /// `true` if the request has not expired.
    is_valid: bool,
}

impl FollowTask {
    /// Creates the task for a hand with these fingers. Requests expire after `lifetime` (s, on the hand's clock).
    pub fn new(requests: Requests, fingers: Vec<FingerGeometry>, lifetime: f64) -> Self {
        Self {
            requests,
            fingers,
            lifetime,
            followed: Request::default(),
            arrived: f64::NEG_INFINITY,
            stepped: f64::NEG_INFINITY,
            is_valid: false,
        }
    }
}

impl Task for FollowTask {
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        let latest = self.requests.follow();
        let was_stopped = hand.stamp - self.stepped >= self.lifetime;
        if was_stopped {
            self.arrived = f64::NEG_INFINITY;
        } else if latest.number != self.followed.number {
            self.arrived = hand.stamp;
        }
        (self.followed, self.stepped) = (latest, hand.stamp);
        self.is_valid = hand.stamp - self.arrived < self.lifetime;
        Ok(())
    }

    fn plan(&self, finger: usize, hand: &HandReadings<'_>) -> Plan {
        let geometry = self.fingers.get(finger).filter(|_| self.is_valid);
        let requested = self.followed.velocities.get(finger);
        let (Some(geometry), Some(&requested)) = (geometry, requested) else {
            return Plan::default();
        };
        let Some(joints) = hand.joints.get(finger) else {
            return Plan::default();
        };
        Plan {
            velocity: jacobian(geometry, joints.position) * requested,
            ..Plan::default()
        }
    }

    fn phase(&self) -> Phase {
        match self.followed.has_ended {
            true => Phase::Done,
            false => Phase::Move,
        }
    }
}
