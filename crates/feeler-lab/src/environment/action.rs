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
    /// Joint velocities (rad/s or m/s), converted to a fingertip velocity by the Jacobian before limiting.
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

    /// Length of a finger's action.
    pub(super) fn width(self, finger: &FingerGeometry) -> usize {
        match self {
            Self::World | Self::Fingertip => 3,
            Self::Joints => finger.joint_count(),
        }
    }

    /// Maximum magnitude of each number of a finger's action that passes the limits unchanged.
    pub(super) fn bounds(self, finger: &FingerGeometry, limits: &LimitsConfig) -> JointVector {
        match self {
            Self::World | Self::Fingertip => JointVector::splat(3, limits.fingertip_speed),
            Self::Joints => finger.joint_speed_limit(),
        }
    }

    /// Converts the action of one finger to a fingertip velocity in W (m/s).
    pub(super) fn velocity(
        self,
        action: &[f64],
        finger: &FingerGeometry,
        sense: &FingerReadings<'_>,
    ) -> DVec3 {
        let bounded = |number: &f64| number.clamp(-MOST, MOST);
        let mut numbers = JointVector::zeros(action.len());
        for (index, number) in action.iter().enumerate().take(numbers.len()) {
            numbers[index] = bounded(number);
        }
        let vector = DVec3::new(numbers[0], numbers[1], numbers[2]);
        match self {
            Self::World => vector,
            Self::Fingertip => sense.pose.rotation * vector,
            Self::Joints => jacobian(finger, sense.joints.position) * numbers,
        }
    }

    /// Converts a fingertip velocity in W (m/s) to an action; the inverse of [`velocity`](Self::velocity).
    pub(super) fn action(
        self,
        velocity: DVec3,
        finger: &FingerGeometry,
        sense: &FingerReadings<'_>,
    ) -> JointVector {
        match self {
            Self::World => velocity.to_array().into(),
            Self::Fingertip => (sense.pose.rotation.transpose() * velocity)
                .to_array()
                .into(),
            Self::Joints => resolved_rate(finger, sense.joints.position, velocity).joint_velocity,
        }
    }
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
