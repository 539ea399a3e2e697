//! What the screw task is tuned by.

use super::cap_config::{CapConfig, Until};
use crate::check::Checker;
use serde::{Deserialize, Serialize};

/// The roughly planned rectangle that each finger goes round.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScrewConfig {
    /// When the strokes end.
    #[serde(default)]
    pub until: Until,
    /// How many times the fingers touch, turn and release; at most, unless it is until this count.
    #[serde(default = "default::strokes")]
    pub strokes: u32,
    /// v_0: speed of the approach, m/s.
    #[serde(default = "default::search_speed")]
    pub search_speed: f64,
    /// A finger that searches stops at this grasp force, N; all fingers there start to move.
    #[serde(default = "default::grasp_force")]
    pub grasp_force: f64,
    /// A finger that has come this far from home and feels no grasp stops the task, m.
    #[serde(default = "default::search_limit")]
    pub search_limit: f64,
    /// v_m: speed of the stroke, m/s.
    #[serde(default = "default::move_speed")]
    pub move_speed: f64,
    /// Length of the stroke, m.
    #[serde(default = "default::travel")]
    pub travel: f64,
    /// Speed of release and return, m/s.
    #[serde(default = "default::return_speed")]
    pub return_speed: f64,
    /// A finger is home within this distance, m.
    #[serde(default = "default::home_tolerance")]
    pub home_tolerance: f64,
    /// What is known of the cap; needed unless the strokes are counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cap: Option<CapConfig>,
    /// Each finger's rectangle.
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

/// One finger's rectangle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerPathConfig {
    /// Where the dome's centre starts from, m, in W.
    pub home: [f64; 3],
    /// Direction in which the finger searches for the object, in W; its length does not matter.
    pub approach: [f64; 3],
    /// Direction of the stroke, in W; its length does not matter.
    pub stroke: [f64; 3],
}

impl ScrewConfig {
    /// Requires every value of the table `key` to be in its range.
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
                "what is known of the cap, as in [{key}.cap], because the strokes are not counted"
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
