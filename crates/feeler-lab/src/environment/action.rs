//! Interpretation of actions.

use super::EnvironmentError;
use feeler::control::{FingerReadings, LimitsConfig};
use feeler::hand::{FingerGeometry, JointVector, jacobian, resolved_rate};
use glam::DVec3;

/// Actions are clamped to this magnitude (m/s or rad/s), which is far above all limits, to prevent overflow.
const MOST: f64 = 1e6;

/// Meaning of the three numbers of an action per finger.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ActionKind {
    /// Fingertip velocity in the world frame `W` (m/s).
    World,
    /// Fingertip velocity in the fingertip frame `T` (m/s), which has the same meaning for fingers that face each
    /// other.
    #[default]
    Fingertip,
    /// Joint velocities theta1 to theta3 (rad/s), converted to a fingertip velocity by the Jacobian before limiting.
    Joints,
}

impl ActionKind {
    /// Names of the action kinds, in the order of the variants.
    pub const NAMES: [&str; 3] = ["world", "fingertip", "joints"];

    /// Returns the kind with the given name, if any.
    pub fn named(name: &str) -> Option<Self> {
        let kinds = [Self::World, Self::Fingertip, Self::Joints];
        let index = Self::NAMES.iter().position(|own| *own == name)?;
        kinds.get(index).copied()
    }

    /// Largest magnitude of each number of a finger's action that no limit changes.
    pub(super) fn bounds(self, finger: &FingerGeometry, limits: &LimitsConfig) -> DVec3 {
        match self {
            Self::World | Self::Fingertip => DVec3::splat(limits.fingertip_speed),
            Self::Joints => of_joints(finger.joint_speed_limit()),
        }
    }

    /// Converts an action of one finger to a fingertip velocity in W (m/s).
    pub(super) fn velocity(
        self,
        action: DVec3,
        finger: &FingerGeometry,
        sense: &FingerReadings<'_>,
    ) -> DVec3 {
        let action = action.clamp(DVec3::splat(-MOST), DVec3::splat(MOST));
        match self {
            Self::World => action,
            Self::Fingertip => sense.pose.rotation * action,
            Self::Joints => jacobian(finger, sense.joints.position) * action,
        }
    }

    /// Converts a fingertip velocity in W (m/s) to an action; the inverse of [`velocity`](Self::velocity).
    pub(super) fn action(
        self,
        velocity: DVec3,
        finger: &FingerGeometry,
        sense: &FingerReadings<'_>,
    ) -> DVec3 {
        match self {
            Self::World => velocity,
            Self::Fingertip => sense.pose.rotation.transpose() * velocity,
            Self::Joints => {
                of_joints(resolved_rate(finger, sense.joints.position, velocity).joint_velocity)
            }
        }
    }
}

/// Joint velocities theta1 to theta3 (rad/s), as in an action.
fn of_joints(velocities: JointVector) -> DVec3 {
    DVec3::new(velocities[0], velocities[1], velocities[2])
}

/// Checks that an action consists of `expected` numbers.
pub(super) fn check_length(action: &[f64], expected: usize) -> Result<(), EnvironmentError> {
    match action.len() {
        actual if actual == expected => Ok(()),
        actual => Err(EnvironmentError::ActionLength { expected, actual }),
    }
}

/// Requires an action of `count` finite numbers.
pub(super) fn check(action: &[f64], count: usize) -> Result<(), EnvironmentError> {
    check_length(action, count)?;
    let mut numbers = action.iter().copied().enumerate();
    match numbers.find(|(_, number)| !number.is_finite()) {
        Some((index, value)) => Err(EnvironmentError::ActionNotFinite { index, value }),
        None => Ok(()),
    }
}
