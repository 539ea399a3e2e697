//! Checks that one servo can move joints of several fingers together in the experiment's task.

use super::{ExperimentError, fingers_at_home};
use crate::config::ExperimentConfig;
use feeler::control::MonitorConfig;
use feeler::control::task::TaskConfig;
use feeler::control::task::grip::GripConfig;
use feeler::hand::{FingerGeometry, JointVector, jacobian, resolved_rate};
use feeler_drives::JointName;
use feeler_drives::config::{DrivesConfig, JointDriveConfig};
use feeler_drives::setup::{joints_of_servo, named_servos, servo_range};
use glam::DVec3;

/// Fraction of `home_tolerance` by which the homes of two fingers may disagree. The rest allows for servos that
/// friction stops short of their goal: emulated ones by up to 16 counts, 0.5 mm at 125 mm of travel per turn.
const HOME_SHARE: f64 = 0.75;

/// Error of a servo that cannot move joints of two fingers together.
#[derive(Debug, thiserror::Error)]
pub enum SharedServoError {
    /// The joints do not close together.
    #[error(
        "{joint}: expected a servo that closes both fingers, but theta{} of finger {} does not close with it; change the direction of one of them, then home the hand", other.joint + 1, other.finger
    )]
    Directions {
        /// First joint of the servo.
        joint: JointName,
        /// Joint that shares the servo.
        other: JointName,
    },
    /// The fingers close at different speeds. The servo follows the slower command, and the hand stops if a joint lags
    /// its command too far.
    #[error(
        "{joint}: expected both fingers to close at similar speeds, but theta{} of finger {} closes {ratio:.3} times as fast (allowed: {least:.2} to {:.2}); check travel_per_turn or gear_ratio of both joints", other.joint + 1, other.finger, 1.0 / least
    )]
    Speeds {
        /// First joint of the servo.
        joint: JointName,
        /// Joint that shares the servo.
        other: JointName,
        /// Closing speed of the other finger, relative to the first.
        ratio: f64,
        /// Minimum ratio.
        least: f64,
    },
    /// The fingers are not at home together.
    #[error(
        "{joint}: with its finger at home, finger {} is {distance:.4} m from its own home (theta{}): expected at most {limit:.4} m ({HOME_SHARE} times task.grip.home_tolerance); run `feeler drives home` with both fingers at home, and check direction and travel_per_turn of both joints", other.finger, other.joint + 1
    )]
    Homes {
        /// First joint of the servo.
        joint: JointName,
        /// Joint that shares the servo.
        other: JointName,
        /// Distance of the fingertip from home (m).
        distance: f64,
        /// Maximum distance (m).
        limit: f64,
    },
}

/// Joint of a servo that moves several joints, with its finger at home.
struct Moved<'a> {
    name: JointName,
    drive: &'a JointDriveConfig,
    geometry: &'a FingerGeometry,
    home: JointVector,
}

impl Moved<'_> {
    /// Velocity of the servo (rad/s) per closing speed of the finger along `approach` (m/s).
    fn closing(&self, approach: [f64; 3]) -> f64 {
        let approach = DVec3::from_array(approach).normalize_or_zero();
        let rate = resolved_rate(self.geometry, self.home, approach);
        self.drive
            .servo_velocity(rate.joint_velocity[self.name.joint])
    }

    /// Distance of the fingertip from home (m) if the joint of `first` has its home position.
    fn distance(&self, first: &Self) -> f64 {
        let horn = first.drive.horn(first.home[first.name.joint]);
        let joint = self.name.joint;
        let away = self.drive.position(horn) - self.home[joint];
        let columns = jacobian(self.geometry, self.home);
        columns.columns()[joint].length() * away.abs()
    }
}

/// Checks that each servo of the table `[drives]` that moves joints of several fingers closes all of them, and that they
/// are at home together. Otherwise, the servo eventually stands still, and the joint monitor stops the hand.
///
/// # Errors
/// If a finger is invalid, if the joints of a servo have no common range, or if they close in opposite
/// directions, at different speeds, or have different homes.
pub fn check_shared_servos(config: &ExperimentConfig) -> Result<(), ExperimentError> {
    // Other tasks are refused with shared servos.
    let (Some(drives), TaskConfig::Grip(task)) = (&config.drives, &config.task) else {
        return Ok(());
    };
    if !drives.joints().any(|drive| drive.shared) {
        return Ok(());
    }
    let (fingers, homes) = fingers_at_home(config)?;
    for (servo, _) in named_servos(drives) {
        servo_range(drives, &fingers, servo)?;
        check_servo(drives, servo.id, task, (&fingers, &homes))?;
    }
    Ok(())
}

/// Checks all joints of the servo with this `id`.
fn check_servo(
    drives: &DrivesConfig,
    id: u8,
    task: &GripConfig,
    (fingers, homes): (&[FingerGeometry], &[JointVector]),
) -> Result<(), SharedServoError> {
    let mut joints = joints_of_servo(drives, id).filter_map(|(name, drive)| {
        let moved = Moved {
            name,
            drive,
            geometry: fingers.get(name.finger)?,
            home: *homes.get(name.finger)?,
        };
        Some((moved, task.finger.get(name.finger)?.approach))
    });
    let Some((first, approach)) = joints.next() else {
        return Ok(());
    };
    let closing = first.closing(approach);
    for (other, approach) in joints {
        check_closing((first.name, other.name), closing / other.closing(approach))?;
        let distance = first.distance(&other).max(other.distance(&first));
        let limit = HOME_SHARE * task.home_tolerance;
        if distance > limit {
            return Err(SharedServoError::Homes {
                joint: first.name,
                other: other.name,
                distance,
                limit,
            });
        }
    }
    Ok(())
}

/// Checks the closing speed of the finger of `other` relative to that of `joint`, at the same speed of their servo.
fn check_closing(
    (joint, other): (JointName, JointName),
    ratio: f64,
) -> Result<(), SharedServoError> {
    // False also for a finger that the servo does not move towards the object.
    if !(ratio.is_finite() && ratio > 0.0) {
        return Err(SharedServoError::Directions { joint, other });
    }
    // The monitor compares the faster finger's command with its motion.
    let least = 1.0 - MonitorConfig::SCALE_TOLERANCE;
    match (least..=1.0 / least).contains(&ratio) {
        true => Ok(()),
        false => Err(SharedServoError::Speeds {
            joint,
            other,
            ratio,
            least,
        }),
    }
}
