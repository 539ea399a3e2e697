//! Checks of faults in an experiment file: ranges of values, and existence of the affected parts.

use super::fault::{FaultConfig, FaultKind};
use crate::objects::object::{MotionConfig, ObjectConfig};
use feeler::check::Checker;
use feeler::sensor::fingertip::FingertipConfig;
use std::collections::BTreeMap;

/// Maximum latency in control periods, because all delayed exposures are stored.
const MAX_LATE_PERIODS: f64 = 1000.0;
/// Maximum gain of a faulty encoder.
const MAX_GAIN: f64 = 1e3;
/// Number of joints assumed for a finger that does not exist.
const USUAL_JOINTS: usize = 3;

/// Parts of an experiment that faults can affect.
#[derive(Debug, Clone, Copy)]
pub struct FaultTargets<'a> {
    /// Fingertip of each finger.
    pub fingertips: &'a [&'a FingertipConfig],
    /// Number of joints of each finger.
    pub joints: &'a [usize],
    /// Control period (s).
    pub period: f64,
    /// Objects by name.
    pub objects: &'a BTreeMap<String, ObjectConfig>,
}

impl FaultConfig {
    /// Checks that every value of the entry `key` is in its range, and that the affected part exists in `targets`.
    pub fn check(&self, key: &str, targets: &FaultTargets<'_>, checker: &mut Checker) {
        checker.not_negative(&format!("{key}.from"), self.from);
        if let Some(until) = self.until {
            checker.require(
                &format!("{key}.until"),
                until.to_string(),
                until.is_finite() && until > self.from,
                &format!("more than {key}.from = {}, or no until", self.from),
            );
        }
        let always = self.from == 0.0 && self.until.is_none();
        checker.require(
            &format!("{key}.from"),
            format!("{} until {:?}", self.from, self.until),
            always || !matches!(self.kind, FaultKind::SwappedSensors { .. }),
            "no from and no until: sensors are swapped during the whole run",
        );
        let key = format!("{key}.kind.{}", self.kind.name());
        self.kind.check(&key, targets, checker);
    }
}

impl FaultKind {
    fn check(&self, key: &str, targets: &FaultTargets<'_>, checker: &mut Checker) {
        let fingertip = self.finger().and_then(|finger| {
            let (key, fingers) = (format!("{key}.finger"), targets.fingertips.len());
            index_below(&key, finger, fingers, "fingers of hand.finger", checker);
            targets.fingertips.get(finger)
        });
        match self {
            &Self::DeadElement { finger, element } => {
                let Some(fingertip) = fingertip else { return };
                let elements = fingertip.layout.element_count();
                let what = format!("elements of finger {finger}");
                index_below(&format!("{key}.element"), element, elements, &what, checker);
            }
            &Self::StuckRows {
                finger,
                first,
                count,
                ..
            } => {
                let Some(fingertip) = fingertip else { return };
                let rows = fingertip.camera.height;
                let what = format!("rows of the images of finger {finger}");
                index_below(&format!("{key}.first"), first, rows, &what, checker);
                let left = rows.saturating_sub(first);
                checker.require(
                    &format!("{key}.count"),
                    count.to_string(),
                    (1..=left).contains(&count) || first >= rows,
                    &format!("1 to {left}: the image has {rows} rows, and the first is {first}"),
                );
            }
            Self::FrozenFrame { .. } => {}
            &Self::DroppedFrames { probability, .. } => {
                checker.between(&format!("{key}.probability"), probability, 0.0, 1.0);
            }
            &Self::CameraLatency { delay, .. } => {
                let most = (MAX_LATE_PERIODS * targets.period).min(10.0);
                checker.between(&format!("{key}.delay"), delay, 0.0, most);
            }
            &Self::ServoStall { finger, joint } | &Self::JointFreeze { finger, joint } => {
                targets.require_joint(key, finger, joint, checker);
            }
            &Self::Backlash {
                finger,
                joint,
                angle,
            } => {
                targets.require_joint(key, finger, joint, checker);
                checker.between(&format!("{key}.angle"), angle, 0.0, 1.0);
            }
            &Self::JointGain {
                finger,
                joint,
                gain,
            } => {
                targets.require_joint(key, finger, joint, checker);
                checker.between(&format!("{key}.gain"), gain, -MAX_GAIN, MAX_GAIN);
            }
            &Self::JointJump {
                finger,
                joint,
                angle,
            } => {
                targets.require_joint(key, finger, joint, checker);
                let good = angle.is_finite();
                checker.require(&format!("{key}.angle"), angle.to_string(), good, "a number");
            }
            &Self::SensorGain { gain, .. } => {
                checker.between(&format!("{key}.gain"), gain, 0.0, MAX_GAIN);
            }
            &Self::SwappedSensors { finger, other } => {
                let (key, fingers) = (format!("{key}.other"), targets.fingertips.len());
                index_below(&key, other, fingers, "fingers of hand.finger", checker);
                let good = other != finger;
                checker.require(&key, other.to_string(), good, "another finger");
            }
            Self::FrictionDrop { object, factor } => {
                checker.between(&format!("{key}.factor"), *factor, 0.0, 1.0);
                if let Some(object) = object {
                    targets.require_object(key, object, "an object", |_| true, checker);
                }
            }
            Self::MassChange { object, mass, over } => {
                checker.positive(&format!("{key}.mass"), *mass);
                checker.not_negative(&format!("{key}.over"), *over);
                targets.require_free_object(key, object, checker);
            }
            Self::Pull {
                object,
                force,
                over,
            } => {
                checker.vector(&format!("{key}.force"), *force);
                checker.not_negative(&format!("{key}.over"), *over);
                targets.require_free_object(key, object, checker);
            }
        }
    }

    /// Key of this kind in an experiment file.
    fn name(&self) -> &'static str {
        match self {
            Self::DeadElement { .. } => "dead_element",
            Self::StuckRows { .. } => "stuck_rows",
            Self::FrozenFrame { .. } => "frozen_frame",
            Self::DroppedFrames { .. } => "dropped_frames",
            Self::CameraLatency { .. } => "camera_latency",
            Self::ServoStall { .. } => "servo_stall",
            Self::Backlash { .. } => "backlash",
            Self::JointFreeze { .. } => "joint_freeze",
            Self::JointGain { .. } => "joint_gain",
            Self::JointJump { .. } => "joint_jump",
            Self::SensorGain { .. } => "sensor_gain",
            Self::SwappedSensors { .. } => "swapped_sensors",
            Self::FrictionDrop { .. } => "friction_drop",
            Self::MassChange { .. } => "mass_change",
            Self::Pull { .. } => "pull",
        }
    }
}

impl FaultTargets<'_> {
    /// Checks that `finger` has the joint with the index `joint`.
    fn require_joint(&self, key: &str, finger: usize, joint: usize, checker: &mut Checker) {
        let joints = self.joints.get(finger).copied().unwrap_or(USUAL_JOINTS);
        index_below(&format!("{key}.joint"), joint, joints, "joints", checker);
    }

    /// Checks that `object` is the name of a free object.
    fn require_free_object(&self, key: &str, object: &str, checker: &mut Checker) {
        let free = |object: &ObjectConfig| matches!(object.motion, MotionConfig::Free(_));
        self.require_object(key, object, "a free object", free, checker);
    }

    /// Checks that `object` is the name of an object that satisfies `fit`.
    fn require_object(
        &self,
        key: &str,
        object: &str,
        what: &str,
        fit: impl Fn(&ObjectConfig) -> bool,
        checker: &mut Checker,
    ) {
        let fit = self.objects.iter().filter(|(_, object)| fit(object));
        let names: Vec<_> = fit.map(|(name, _)| name.as_str()).collect();
        checker.require(
            &format!("{key}.object"),
            format!("{object:?}"),
            names.contains(&object),
            &format!("the name of {what}: {}", names.join(", ")),
        );
    }
}

/// Checks that `index` is below `count`.
fn index_below(key: &str, index: usize, count: usize, what: &str, checker: &mut Checker) {
    checker.require(
        key,
        index.to_string(),
        index < count,
        &format!(
            "0 to {}: there are {count} {what}, counted from 0",
            count.saturating_sub(1)
        ),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_affects_a_joint_of_its_finger() {
        let objects = BTreeMap::new();
        let fingertip = FingertipConfig::default();
        let targets = FaultTargets {
            fingertips: &[&fingertip; 3],
            joints: &[3, 4, 7],
            period: 0.01,
            objects: &objects,
        };
        for (finger, joints) in [3, 4, 7].into_iter().enumerate() {
            for joint in 0..=8 {
                let mut checker = Checker::default();
                let fault = FaultKind::ServoStall { finger, joint };
                fault.check("fault", &targets, &mut checker);
                let problems = checker.problems();
                assert_eq!(problems.is_empty(), joint < joints, "{finger}, {joint}");
                if let Some(problem) = problems.first() {
                    let most = joints - 1;
                    let expected = format!(
                        "fault.joint = {joint}: expected 0 to {most}: there are {joints} joints, counted from 0"
                    );
                    assert_eq!(problem.to_string(), expected);
                }
            }
        }
    }
}
