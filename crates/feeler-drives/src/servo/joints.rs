//! All joints that one servo moves, such as both jaws of a gripper.

use super::joint::{JointLimits, ServoJoint};
use crate::config::{DrivesConfig, JointDriveConfig};
use crate::error::{DriveError, JointName};
use crate::packet::Protocol;
use crate::registers::Model;
use crate::setup::joints_of_servo;
use feeler::hand::FingerGeometry;

/// The joints that a servo moves.
#[derive(Debug, Clone)]
pub(crate) struct ServoJoints {
    /// The joint with the settings of the servo, which counts for names, limits and goals of the servo.
    pub first: ServoJoint,
    /// Joints of later fingers, which share the servo.
    others: Vec<ServoJoint>,
    /// Intersection of the limits of all joints, converted to the first one.
    pub limits: JointLimits,
}

impl ServoJoints {
    /// Creates the joints that the servo of `joint` moves in a hand with these `fingers`.
    ///
    /// # Errors
    /// If the hand has no such joint, or if no position of the servo is within the limits of all its joints.
    pub fn of(
        config: &DrivesConfig,
        fingers: &[FingerGeometry],
        joint: JointName,
    ) -> Result<Self, DriveError> {
        let mut joints = joints_of_servo(config, joint.id).filter_map(|(name, drive)| {
            let geometry = fingers.get(name.finger)?;
            Some(ServoJoint::new(name, drive, geometry))
        });
        let first = joints.next();
        let first =
            first.ok_or_else(|| DriveError::no_joint(joint.finger, joint.joint, fingers))?;
        let others: Vec<_> = joints.collect();
        let mut limits = first.limits;
        for other in &others {
            let by = first.converted_limits(other);
            limits = JointLimits {
                lower: limits.lower.max(by.lower),
                upper: limits.upper.min(by.upper),
                speed: limits.speed.min(by.speed),
            };
            if limits.lower >= limits.upper {
                return Err(DriveError::NoCommonRange {
                    joint: first.name,
                    other: other.name,
                    lower: by.lower,
                    upper: by.upper,
                    unit: first.unit(),
                });
            }
        }
        Ok(Self {
            first,
            others,
            limits,
        })
    }

    /// All joints, the first one first.
    pub fn iter(&self) -> impl Iterator<Item = &ServoJoint> {
        std::iter::once(&self.first).chain(&self.others)
    }

    /// Range of `joint` (rad or m) within which all joints are within their limits.
    pub fn range_of(&self, joint: JointName) -> (f64, f64) {
        let (lower, upper) = (self.limits.lower, self.limits.upper);
        let other = self.others.iter().find(|other| other.name == joint);
        other.map_or((lower, upper), |other| {
            let ends = [lower, upper].map(|end| other.drive.position(self.first.drive.horn(end)));
            (ends[0].min(ends[1]), ends[0].max(ends[1]))
        })
    }

    /// Maximum speed at which the joint of `drive` may be jogged (rad/s or m/s): no joint of the servo exceeds its own
    /// maximum.
    pub fn jog_speed(&self, drive: &JointDriveConfig) -> f64 {
        let limit = |joint: &ServoJoint| {
            let ratio = drive.ratio_to(&joint.drive);
            (ratio * joint.drive.jog_speed()).abs()
        };
        self.iter().map(limit).fold(f64::INFINITY, f64::min)
    }

    /// Unwraps a position that a servo of `model` reports, counts: positions of Feetech STS servos wrap after a turn. Chooses
    /// the equivalent position nearest to the `previous` one, or initially to the middle of the range.
    pub fn unwrap_position(&self, model: &Model, reported: i64, previous: Option<i64>) -> i64 {
        if model.protocol != Protocol::Feetech {
            return reported;
        }
        let turn = model.counts;
        let middle = (self.limits.lower + self.limits.upper) / 2.0;
        let near = || model.to_counts(self.first.drive.horn(middle)).round() as i64;
        let near = previous.unwrap_or_else(near);
        near + (reported - near + turn / 2).rem_euclid(turn) - turn / 2
    }

    /// Updates all joints from the angle (rad) and velocity (rad/s) of the servo's horn.
    pub fn update(&mut self, horn: f64, velocity: f64) {
        self.first.update(horn, velocity);
        for other in &mut self.others {
            other.update(horn, velocity);
        }
    }

    /// Returns the velocity of the first joint (rad/s or m/s) for the slowest of the joints' commands `velocity`, or 0 if their
    /// directions differ.
    ///
    /// # Errors
    /// If a command exceeds the speed limit of its joint.
    pub fn common_velocity(
        &self,
        velocity: impl Fn(&ServoJoint) -> f64,
    ) -> Result<f64, DriveError> {
        let own = velocity(&self.first);
        self.first.check_command(own, self.first.limits.speed)?;
        self.others.iter().try_fold(own, |slowest, other| {
            let commanded = velocity(other);
            other.check_command(commanded, other.limits.speed)?;
            let own = self.first.drive.ratio_to(&other.drive) * commanded;
            Ok(match own * slowest > 0.0 {
                true if own.abs() < slowest.abs() => own,
                true => slowest,
                false => 0.0,
            })
        })
    }
}
