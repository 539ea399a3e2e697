//! What an agent's numbers mean.

use super::EnvironmentError;
use feeler::control::limits::LimitsConfig;
use feeler::control::sense::FingerSense;
use feeler::hand::finger::FingerGeometry;
use feeler::hand::kinematics::jacobian;
use feeler::hand::resolved_rate::resolved_rate;
use glam::DVec3;

/// No number of an action counts for more, m/s or rad/s: far beyond all limits, and nothing that is made of it overflows.
const MOST: f64 = 1e6;

/// What the three numbers of an action for each finger mean.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ActionKind {
    /// The fingertip's velocity in the world `W`, m/s.
    World,
    /// The fingertip's velocity in its own frame `T`, m/s: the same for fingers that face each other.
    #[default]
    Fingertip,
    /// Joint velocities theta1..theta3, rad/s. The limits get the fingertip velocity that they make, by the Jacobian.
    Joints,
}

impl ActionKind {
    /// The names of all kinds.
    pub const NAMES: [&str; 3] = ["world", "fingertip", "joints"];

    /// The kind of this name, if there is one.
    pub fn named(name: &str) -> Option<Self> {
        let kinds = [Self::World, Self::Fingertip, Self::Joints];
        let index = Self::NAMES.iter().position(|own| *own == name)?;
        kinds.get(index).copied()
    }

    /// How large the three numbers of a finger can be before a limit changes them, whatever their sign.
    pub(super) fn bounds(self, finger: &FingerGeometry, limits: &LimitsConfig) -> DVec3 {
        match self {
            Self::World | Self::Fingertip => DVec3::splat(limits.fingertip_speed),
            Self::Joints => finger.joint_speed_limit(),
        }
    }

    /// The fingertip velocity that `action` asks of a finger, m/s, in W.
    pub(super) fn velocity(
        self,
        action: DVec3,
        finger: &FingerGeometry,
        sense: &FingerSense<'_>,
    ) -> DVec3 {
        let action = action.clamp(DVec3::splat(-MOST), DVec3::splat(MOST));
        match self {
            Self::World => action,
            Self::Fingertip => sense.pose.rotation * action,
            Self::Joints => jacobian(finger, sense.joints.position) * action,
        }
    }

    /// The action that asks for `velocity`, m/s, in W: the other way round.
    pub(super) fn action(
        self,
        velocity: DVec3,
        finger: &FingerGeometry,
        sense: &FingerSense<'_>,
    ) -> DVec3 {
        match self {
            Self::World => velocity,
            Self::Fingertip => sense.pose.rotation.transpose() * velocity,
            Self::Joints => resolved_rate(finger, sense.joints.position, velocity).joint_velocity,
        }
    }
}

/// Requires room for `expected` numbers.
pub(super) fn check_length(action: &[f64], expected: usize) -> Result<(), EnvironmentError> {
    match action.len() {
        actual if actual == expected => Ok(()),
        actual => Err(EnvironmentError::ActionLength { expected, actual }),
    }
}

/// Requires `count` finite numbers.
pub(super) fn check(action: &[f64], count: usize) -> Result<(), EnvironmentError> {
    check_length(action, count)?;
    let mut numbers = action.iter().copied().enumerate();
    match numbers.find(|(_, number)| !number.is_finite()) {
        Some((index, value)) => Err(EnvironmentError::ActionNotFinite { index, value }),
        None => Ok(()),
    }
}
