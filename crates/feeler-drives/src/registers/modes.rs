//! Modes in which a servo follows its joint's velocity, and the operating modes that they require.

use super::{Register, Registers};
use crate::packet::Protocol;
use serde::{Deserialize, Serialize};

/// Mode in which a servo follows the commanded velocity of its joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DriveMode {
    /// The servo controls its velocity. A stalled motor pushes with all its torque.
    #[default]
    Velocity,
    /// Position control by the servo. The goal position integrates the commanded velocity, and stays within
    /// [`leash`](crate::config::JointDriveConfig::leash) of the measured position.
    Position,
    /// Like `Position`, with a limited current (Feetech: a limited fraction of the motor's voltage).
    CurrentLimitedPosition,
}

/// Kind of value that a servo follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GoalKind {
    /// Goal velocity, in the model's unit.
    Velocity,
    /// Goal position, counts.
    Position,
}

impl GoalKind {
    /// All kinds.
    pub const ALL: [Self; 2] = [Self::Velocity, Self::Position];
}

impl DriveMode {
    /// All modes.
    pub const ALL: [Self; 3] = [Self::Velocity, Self::Position, Self::CurrentLimitedPosition];

    /// Operating mode in the servo's control table, if it has this register. `Position` is Dynamixel's extended position
    /// control, whose positions do not wrap.
    pub fn number(self, protocol: Protocol) -> i64 {
        match (protocol, self) {
            (Protocol::Dynamixel, Self::Velocity) => 1,
            (Protocol::Dynamixel, Self::Position) => 4,
            (Protocol::Dynamixel, Self::CurrentLimitedPosition) => 5,
            (Protocol::Feetech | Protocol::FeetechScs, Self::Velocity) => 1,
            (Protocol::Feetech | Protocol::FeetechScs, _) => 0,
        }
    }

    /// Modes that servos with `protocol` support.
    pub fn supported(protocol: Protocol) -> &'static [Self] {
        match protocol {
            Protocol::Dynamixel | Protocol::Feetech => &Self::ALL,
            Protocol::FeetechScs => &[Self::Position],
        }
    }

    /// Kind of value that the servo follows.
    pub fn goal(self) -> GoalKind {
        match self {
            Self::Velocity => GoalKind::Velocity,
            Self::Position | Self::CurrentLimitedPosition => GoalKind::Position,
        }
    }

    /// Name as in an experiment file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Position => "position",
            Self::CurrentLimitedPosition => "current-limited-position",
        }
    }
}

impl Registers {
    /// Register of the goal.
    pub fn goal(&self, kind: GoalKind) -> Register {
        match kind {
            GoalKind::Velocity => self.goal_velocity,
            GoalKind::Position => self.goal_position,
        }
    }
}
