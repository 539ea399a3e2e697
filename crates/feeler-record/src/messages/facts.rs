//! Facts of a run: the constants that a report needs in addition to the messages.

use super::model::{FingerModel, Solid, validate_solids};
use super::names::{SensingKind, TaskKind};
use crate::error::RecordError;
use crate::wire::WireError;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Maximum number of fingers of a recording. Guards against damaged files.
pub const MAX_FINGERS: usize = 16;

/// Valid control periods of a recording (s). Guards against damaged files.
const PERIODS: std::ops::RangeInclusive<f64> = 1e-4..=1.0;

/// Facts that are written as plain text; all others are written as JSON.
const TEXT_FIELDS: [&str; 6] = [
    "experiment",
    "task",
    "version",
    "sensing",
    "law",
    "replay_of",
];

/// The constants of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunFacts {
    /// Name of the experiment.
    pub experiment: String,
    /// Task of the run.
    #[serde(default = "screw")]
    pub task: TaskKind,
    /// Seed of every random quantity.
    pub seed: u64,
    /// Version of the program that ran it.
    pub version: String,
    /// Source of the forces.
    pub sensing: SensingKind,
    /// Name of the control law, as in the experiment file, such as `tri-axial`, or [`REQUESTS`](Self::REQUESTS). Not part
    /// of the digest, because the experiment is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<String>,
    /// Period of the control loop (s), 0.0001 to 1.
    pub control_period: f64,
    /// Number of fingers.
    pub fingers: usize,
    /// Radius of the cap (m), or 0 if there is no cap.
    pub cap_radius: f64,
    /// Radius of a feeler's tip (m).
    pub feeler_tip_radius: f64,
    /// F1 (N): an element pressed harder than this touches.
    pub touch_force_threshold: f64,
    /// F2 (N): an element pressed harder than this prevents re-compression.
    pub over_force_threshold: f64,
    /// dr (N/s): an element with a larger shear rate counts as slipping.
    pub slip_threshold: f64,
    /// Grasp force or load of a finger at which SEARCH ends (N).
    pub grasp_force_threshold: f64,
    /// Direction in which each finger approaches the object, as a unit vector in `W`.
    pub approach: Vec<[f64; 3]>,
    /// Planned direction of each finger's stroke, as a unit vector in `W`.
    pub stroke_direction: Vec<[f64; 3]>,
    /// Number of strokes to make.
    pub stroke_count: u32,
    /// True cross-section of an object whose outline the task traces, at the height of the finger: successive points in
    /// `W` (m). Known only in simulated worlds. Not part of the digest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub section: Vec<[f64; 2]>,
    /// Ground truth of a simulated world by name, in SI units, such as `specimen.static_friction`. Not part of the
    /// digest.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub truth: BTreeMap<String, f64>,
    /// Limits for a cap that is screwed until it is closed or open, or `None` if the task only counts strokes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cap: Option<CapFacts>,
    /// Goal of a carry task, or `None` in recordings of other tasks and in older ones. Not part of the digest, because
    /// it follows from the experiment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carry: Option<CarryGoal>,
    /// Geometry of each finger, or empty if unknown. Not part of the digest, because it follows from the experiment.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hand: Vec<FingerModel>,
    /// Solids around the hand. Known only in simulated worlds. Not part of the digest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub solids: Vec<Solid>,
    /// In a replay, the digest of the replayed recording. Joint angles, torque and cap were copied from that recording
    /// and do not result from this recording's commands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub replay_of: Option<String>,
}

/// Limits for a cap that is screwed until it is closed or open.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CapFacts {
    /// 1 if the strokes close the cap, -1 if they open it.
    pub sense: f64,
    /// Torque limit by friction (N·m), greater than 0: static coefficient times maximum grip times radius times
    /// fingers.
    pub friction_limit: f64,
    /// Force on an element that damages it if sustained (N).
    pub damage_force: f64,
}

/// Goal of a carry task: the path's end and height, and the maximum grip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CarryGoal {
    /// End of the path relative to where the object was grasped, in `W` (m).
    pub end: [f64; 3],
    /// Maximum height of the path above where the object was grasped (m).
    pub highest: f64,
    /// Force that no finger may reach (N), greater than 0.
    pub crush_force: f64,
}

/// The task of old recordings, which do not contain the name of their task.
fn screw() -> TaskKind {
    TaskKind::Screw
}

impl RunFacts {
    /// Value of [`law`](Self::law) if another program requested the joint velocities.
    pub const REQUESTS: &str = "requests";

    /// Returns `true` if another program requested the joint velocities, so that the experiment's task was not executed.
    pub fn followed_requests(&self) -> bool {
        self.law.as_deref() == Some(Self::REQUESTS)
    }

    /// Returns `true` if `finger` has three joints, or its geometry is unknown.
    pub(crate) fn has_three_joints(&self, finger: usize) -> bool {
        let model = self.hand.get(finger);
        model.is_none_or(|model| model.geometry.joint_count() == 3)
    }

    /// Checks the values that reports rely on.
    ///
    /// # Errors
    /// If a field is out of range. The error names the first one.
    pub fn validate(&self) -> Result<(), RecordError> {
        if !(1..=MAX_FINGERS).contains(&self.fingers) {
            let expected = format!("1 to {MAX_FINGERS}");
            return Err(facts_error("fingers", &expected, self.fingers));
        }
        if !PERIODS.contains(&self.control_period) {
            let expected = format!("{} to {} s", PERIODS.start(), PERIODS.end());
            return Err(facts_error(
                "control_period",
                &expected,
                self.control_period,
            ));
        }
        let finite = [
            ("cap_radius", self.cap_radius),
            ("feeler_tip_radius", self.feeler_tip_radius),
            ("touch_force_threshold", self.touch_force_threshold),
            ("over_force_threshold", self.over_force_threshold),
            ("slip_threshold", self.slip_threshold),
            ("grasp_force_threshold", self.grasp_force_threshold),
        ];
        for (field, value) in finite {
            if !(value.is_finite() && value >= 0.0) {
                return Err(facts_error(field, "a number of at least 0", value));
            }
        }
        if let Some(cap) = &self.cap {
            let good = |value: f64| value.is_finite() && value > 0.0;
            if !(cap.sense.abs() == 1.0 && good(cap.friction_limit) && good(cap.damage_force)) {
                let expected = "sense 1 or -1, friction_limit and damage_force above 0";
                return Err(facts_error("cap", expected, format!("{cap:?}")));
            }
        }
        if let Some(carry) = &self.carry {
            let mut numbers = carry.end.iter().chain([&carry.highest, &carry.crush_force]);
            if !(numbers.all(|number| number.is_finite()) && carry.crush_force > 0.0) {
                let expected = "finite numbers, crush_force above 0";
                return Err(facts_error("carry", expected, format!("{carry:?}")));
            }
        }
        if !(self.hand.is_empty() || self.hand.len() == self.fingers) {
            let expected = format!("the geometry of each of {} fingers", self.fingers);
            return Err(facts_error("hand", &expected, self.hand.len()));
        }
        for model in &self.hand {
            model.validate()?;
        }
        validate_solids(&self.solids)?;
        self.validate_directions("approach", &self.approach)?;
        self.validate_directions("stroke_direction", &self.stroke_direction)
    }

    fn validate_directions(
        &self,
        field: &'static str,
        directions: &[[f64; 3]],
    ) -> Result<(), RecordError> {
        // Only the screw task has planned strokes.
        if directions.is_empty() && self.task != TaskKind::Screw {
            return Ok(());
        }
        if directions.len() != self.fingers {
            let expected = format!("one direction for each of {} fingers", self.fingers);
            return Err(facts_error(field, &expected, directions.len()));
        }
        for d in directions {
            let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            // Written so that NaN is rejected, too.
            let is_unit = (length - 1.0).abs() < 1e-3;
            if !is_unit {
                return Err(facts_error(field, "unit vectors", format!("{d:?}")));
            }
        }
        Ok(())
    }

    /// Converts the facts to the names and texts of the recording's metadata.
    pub(crate) fn to_map(&self) -> Result<BTreeMap<String, String>, RecordError> {
        let value = serde_json::to_value(self).map_err(|e| WireError::Encode {
            schema: "run facts",
            reason: e.to_string(),
        })?;
        let Value::Object(object) = value else {
            return Ok(BTreeMap::new());
        };
        let text = |value: Value| match value {
            Value::String(text) => text,
            other => other.to_string(),
        };
        Ok(object.into_iter().map(|(k, v)| (k, text(v))).collect())
    }

    /// Parses the facts from a recording's metadata.
    ///
    /// # Errors
    /// If a fact is missing or invalid. Returns a description.
    pub(crate) fn from_map(map: &BTreeMap<String, String>) -> Result<Self, String> {
        let value = |(key, text): (&String, &String)| {
            let value = if TEXT_FIELDS.contains(&key.as_str()) {
                Value::String(text.clone())
            } else {
                serde_json::from_str(text).map_err(|e| format!("run fact {key}: {e}"))?
            };
            Ok((key.clone(), value))
        };
        let object: Result<serde_json::Map<_, _>, String> = map.iter().map(value).collect();
        let facts: Self = serde_json::from_value(Value::Object(object?))
            .map_err(|e| format!("run facts: {e}"))?;
        facts.validate().map_err(|e| e.to_string())?;
        Ok(facts)
    }
}

fn facts_error(field: &'static str, expected: &str, actual: impl ToString) -> RecordError {
    RecordError::Facts {
        field,
        expected: expected.into(),
        actual: actual.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(task: &str) -> BTreeMap<String, String> {
        let facts = [
            ("experiment", "made-up"),
            ("task", task),
            ("seed", "0"),
            ("version", "0.1.0"),
            ("sensing", "direct"),
            ("control_period", "0.01"),
            ("fingers", "1"),
            ("cap_radius", "0.0"),
            ("feeler_tip_radius", "0.001"),
            ("touch_force_threshold", "0.1"),
            ("over_force_threshold", "1.5"),
            ("slip_threshold", "3.0"),
            ("grasp_force_threshold", "1.0"),
            ("approach", "[]"),
            ("stroke_direction", "[]"),
            ("stroke_count", "1"),
        ];
        let facts = facts.map(|(key, value)| (key.to_string(), value.to_string()));
        BTreeMap::from(facts)
    }

    #[test]
    fn facts_without_a_goal_and_of_an_unknown_task_are_readable() {
        let facts = RunFacts::from_map(&map("carry")).expect("facts");
        assert_eq!((facts.task, facts.carry), (TaskKind::Carry, None));
        let facts = RunFacts::from_map(&map("juggle")).expect("facts");
        assert!(matches!(&facts.task, TaskKind::Other(task) if task == "juggle"));
        assert_eq!(facts.to_map().expect("a map"), map("juggle"));
    }

    #[test]
    fn a_goal_is_read_as_it_was_written_and_checked() {
        let mut facts = RunFacts::from_map(&map("carry")).expect("facts");
        let goal = CarryGoal {
            end: [0.03, 0.0, 0.0],
            highest: 0.02,
            crush_force: 2.5,
        };
        facts.carry = Some(goal);
        let again = RunFacts::from_map(&facts.to_map().expect("a map"));
        assert_eq!(again.as_ref(), Ok(&facts));
        for crush_force in [0.0, f64::NAN] {
            facts.carry = Some(CarryGoal {
                crush_force,
                ..goal
            });
            let error = facts.validate().expect_err("no goal").to_string();
            assert!(error.contains("carry"), "{error}");
        }
    }
}
