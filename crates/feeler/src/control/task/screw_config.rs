//! Configuration of the screw task.

use super::cap_config::{CapConfig, Until};
use crate::check::Checker;
use serde::{Deserialize, Serialize};

/// Parameters of the screw task, in which each finger follows an approximately planned rectangular path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScrewConfig {
    /// Condition that ends the strokes.
    #[serde(default)]
    pub until: Until,
    /// Number of times that the fingers grasp, turn and release; the maximum number unless `until` is `strokes`.
    #[serde(default = "default::strokes")]
    pub strokes: u32,
    /// v_0: speed of the approach (m/s).
    #[serde(default = "default::search_speed")]
    pub search_speed: f64,
    /// Grasp force at which a searching finger stops (N). Once all fingers have reached it, the stroke begins.
    #[serde(default = "default::grasp_force")]
    pub grasp_force: f64,
    /// Maximum travel from home without a grasp (m). If a finger exceeds it, the hand is stopped.
    #[serde(default = "default::search_limit")]
    pub search_limit: f64,
    /// v_m: speed of the stroke (m/s).
    #[serde(default = "default::move_speed")]
    pub move_speed: f64,
    /// Length of the stroke (m).
    #[serde(default = "default::travel")]
    pub travel: f64,
    /// Speed of release and return (m/s).
    #[serde(default = "default::return_speed")]
    pub return_speed: f64,
    /// Maximum distance from home for a finger to count as returned (m).
    #[serde(default = "default::home_tolerance")]
    pub home_tolerance: f64,
    /// Properties of the cap; required unless `until` is `strokes`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cap: Option<CapConfig>,
    /// Rectangular path of each finger.
    pub finger: Vec<FingerPathConfig>,
}

defaults! {
    strokes: u32 = 4,
    search_speed: f64 = 0.0025,
    grasp_force: f64 = 1.0,
    search_limit: f64 = 0.012,
    move_speed: f64 = 0.0083,
    travel: f64 = 0.0093,
    return_speed: f64 = 0.020,
    home_tolerance: f64 = 0.0002,
}

/// Rectangular path of one finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerPathConfig {
    /// Start position of the dome's centre (m, in W).
    pub home: [f64; 3],
    /// Search direction (in W); its length does not matter.
    pub approach: [f64; 3],
    /// Direction of the stroke (in W); its length does not matter.
    pub stroke: [f64; 3],
}

impl ScrewConfig {
    /// Checks that every value of the table `key` is within its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.between(&format!("{key}.strokes"), self.strokes.into(), 1.0, 1e5);
        let positive = [
            ("search_speed", self.search_speed),
            ("grasp_force", self.grasp_force),
            ("search_limit", self.search_limit),
            ("move_speed", self.move_speed),
            ("travel", self.travel),
            ("return_speed", self.return_speed),
            ("home_tolerance", self.home_tolerance),
        ];
        checker.all_positive(key, &positive);
        checker.require(
            &format!("{key}.cap"),
            "none".to_string(),
            self.until == Until::Strokes || self.cap.is_some(),
            &format!(
                "a table [{key}.cap] with the properties of the cap, unless until = \"strokes\""
            ),
        );
        if let Some(cap) = &self.cap {
            let grasp_force = (&*format!("{key}.grasp_force"), self.grasp_force);
            cap.check(&format!("{key}.cap"), grasp_force, checker);
        }
        for (index, finger) in self.finger.iter().enumerate() {
            checker.vector(&format!("{key}.finger[{index}].home"), finger.home);
            for (field, direction) in [("approach", finger.approach), ("stroke", finger.stroke)] {
                checker.direction(&format!("{key}.finger[{index}].{field}"), direction);
            }
        }
    }
}
