//! What a run was: the constants that a report needs beside the messages.

use super::error::RecordError;
use super::model::{FingerModel, Solid, validate_solids};
use super::names::{SensingKind, TaskKind};
use crate::wire::WireError;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Most fingers that a recording may have; a guard against damaged files.
pub const MAX_FINGERS: usize = 16;

/// Control periods that a recording may have, s; a guard against damaged files, too.
const PERIODS: std::ops::RangeInclusive<f64> = 1e-4..=1.0;

/// Facts whose value is a text, written as it stands; all others are written as JSON.
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
    /// Which task it was.
    #[serde(default = "screw")]
    pub task: TaskKind,
    /// Seed of every random quantity.
    pub seed: u64,
    /// Version of the program that ran it.
    pub version: String,
    /// How forces were obtained.
    pub sensing: SensingKind,
    /// Name of the control law, as in the experiment file: `tri-axial`. Not part of the digest, as the experiment is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<String>,
    /// Period of the control loop, s, 0.0001 to 1.
    pub control_period: f64,
    /// Number of fingers.
    pub fingers: usize,
    /// Radius of the cap, m; 0 where there is none.
    pub cap_radius: f64,
    /// Radius of a feeler's tip, m.
    pub feeler_tip_radius: f64,
    /// F1: an element pressed harder than this touches, N.
    pub touch_force_threshold: f64,
    /// F2: an element pressed harder than this forbids re-compression, N.
    pub over_force_threshold: f64,
    /// dr: an element whose shear rate exceeds this slips, N/s.
    pub slip_threshold: f64,
    /// Grasp force or load of a finger at which SEARCH ends, N.
    pub grasp_force_threshold: f64,
    /// Direction in which each finger approaches the object, unit vector in `W`.
    pub approach: Vec<[f64; 3]>,
    /// Planned direction of each finger's stroke, unit vector in `W`.
    pub stroke_direction: Vec<[f64; 3]>,
    /// Number of strokes to make.
    pub stroke_count: u32,
    /// True section of the object whose outline is to be drawn, at the height of the finger: points in `W`, m, one
    /// after the other. Only simulated worlds know it. Not
    /// part of the digest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub section: Vec<[f64; 2]>,
    /// What a simulated world knows and the hand does not, by name, in SI units: `specimen.static_friction`. Not
    /// part of the digest.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub truth: BTreeMap<String, f64>,
    /// What a cap that is screwed until it is closed or open is held to; none where strokes are counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cap: Option<CapFacts>,
    /// What a task of carrying is held to; none in recordings of other tasks and in older ones. It
    /// follows from the experiment, and is no part of the digest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carry: Option<CarryGoal>,
    /// How each finger is built; empty where that is not known. It follows from the experiment, and is no part of the
    /// digest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hand: Vec<FingerModel>,
    /// What stands around the hand. Only simulated worlds know it. Not part of the digest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub solids: Vec<Solid>,
    /// Of a replay: the digest of what was replayed. Joint angles, torque and cap are from there, and did
    /// not follow from this recording's commands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub replay_of: Option<String>,
}

/// What a cap that is screwed until it is closed or open is held to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CapFacts {
    /// 1 where the strokes close the cap, -1 where they open it.
    pub sense: f64,
    /// Torque that friction allows: static coefficient times the grip allowed times radius times fingers, N·m, more than 0.
    pub friction_limit: f64,
    /// Force on an element that damages it if it stays, N.
    pub damage_force: f64,
}

/// Where an object is to be carried, and how hard it may be gripped.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CarryGoal {
    /// The path's end from where the object was taken, m in `W`.
    pub end: [f64; 3],
    /// The path's highest place above where the object was taken, m.
    pub highest: f64,
    /// Force with which no finger may press, N, more than 0.
    pub crush_force: f64,
}

/// The only task that there was when recordings did not name theirs.
fn screw() -> TaskKind {
    TaskKind::Screw
}

impl RunFacts {
    /// Checks what the report relies on.
    ///
    /// # Errors
    /// The first field that is out of its range.
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
                return Err(facts_error(field, "a number from 0", value));
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
            let expected = format!("the build of each of {} fingers", self.fingers);
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
        // Only what is screwed goes round planned rectangles.
        if directions.is_empty() && self.task != TaskKind::Screw {
            return Ok(());
        }
        if directions.len() != self.fingers {
            let expected = format!("one direction for each of {} fingers", self.fingers);
            return Err(facts_error(field, &expected, directions.len()));
        }
        for d in directions {
            let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            // Written so that a NaN is no unit vector either.
            let is_unit = (length - 1.0).abs() < 1e-3;
            if !is_unit {
                return Err(facts_error(field, "unit vectors", format!("{d:?}")));
            }
        }
        Ok(())
    }

    /// The facts as names and texts, as they stand in the recording.
    pub(super) fn to_map(&self) -> Result<BTreeMap<String, String>, RecordError> {
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

    /// Reads the facts back.
    ///
    /// # Errors
    /// What is missing or wrong, in words.
    pub(super) fn from_map(map: &BTreeMap<String, String>) -> Result<Self, String> {
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
