//! Conversion of a joint's velocity to the value of a servo's goal register.

use crate::config::JointDriveConfig;
use crate::packet::Protocol;
use crate::registers::{GoalKind, Model};
use feeler::hand::LeashedGoal;

/// Goal of a servo, which follows the velocity of its joint.
#[derive(Debug, Clone, Copy)]
pub(super) enum Follower {
    /// Accumulated rounding error of the goals, in the model's unit.
    Velocity {
        left_out: f64,
    },
    Position(LeashedGoal),
}

impl Follower {
    /// Creates the follower for the mode of `drive`, with the `limits`, `speed` and default leash.
    pub fn new(drive: &JointDriveConfig, limits: (f64, f64), speed: f64, usual_leash: f64) -> Self {
        match drive.mode().goal() {
            GoalKind::Velocity => Self::Velocity { left_out: 0.0 },
            GoalKind::Position => Self::Position(LeashedGoal {
                position: 0.0,
                leash: drive.leash.unwrap_or(usual_leash),
                limits,
                speed,
            }),
        }
    }

    /// Discards the previous goal and holds the joint at `position`.
    pub fn hold(&mut self, position: f64) {
        match self {
            Self::Velocity { left_out } => *left_out = 0.0,
            Self::Position(goal) => goal.hold(position),
        }
    }

    /// Advances the goal by the joint's `velocity`, and returns the value of the goal register. The joint was measured at
    /// `position`, `elapsed` seconds after the previous measurement.
    ///
    /// Since a servo's unit of velocity is coarse, the rounding error of one goal velocity is added to the next, so that
    /// the mean is exact.
    pub fn follow(
        &mut self,
        velocity: f64,
        position: f64,
        elapsed: f64,
        drive: &JointDriveConfig,
        model: &Model,
    ) -> i64 {
        match self {
            Self::Velocity { left_out } if velocity != 0.0 => {
                let wanted = drive.servo_velocity(velocity) / model.velocity_unit + *left_out;
                *left_out = wanted - wanted.round();
                wanted.round() as i64
            }
            Self::Velocity { .. } => self.stop(drive, model),
            Self::Position(goal) => {
                goal.advance(velocity, elapsed, position);
                position_counts(drive, model, goal.position)
            }
        }
    }

    /// Returns the value of the goal register that stops the joint: zero velocity, or the latest goal position.
    pub fn stop(&mut self, drive: &JointDriveConfig, model: &Model) -> i64 {
        match self {
            Self::Velocity { left_out } => {
                *left_out = 0.0;
                0
            }
            Self::Position(goal) => position_counts(drive, model, goal.position),
        }
    }
}

/// Goal position of a servo, counts. Positions of Feetech servos are within a turn, or within the range of a potentiometer.
fn position_counts(drive: &JointDriveConfig, model: &Model, position: f64) -> i64 {
    let counts = model.to_counts(drive.horn(position)).round() as i64;
    match model.protocol {
        Protocol::Dynamixel => counts,
        Protocol::Feetech => counts.rem_euclid(model.counts),
        Protocol::FeetechScs => counts.clamp(0, model.counts - 1),
    }
}
