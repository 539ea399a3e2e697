//! Configuration of the friction scan.

use crate::check::Checker;
use crate::control::flags::FlagThresholds;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Minimum angle between sliding and pressing direction (degrees).
const MIN_SLIDE: f64 = 5.0;
/// Minimum settling time in control periods. The noise is measured in half of them.
const MIN_PERIODS_AT_REST: f64 = 20.0;

defaults! {
    search_speed: f64 = 0.004,
    search_limit: f64 = 0.012,
    load: f64 = 1.0,
    load_gain: f64 = 0.005,
    settle_time: f64 = 0.5,
    slide_speed: f64 = 0.001,
    travel: f64 = 0.004,
    slide_limit: f64 = 0.016,
    strokes: u32 = 5,
    return_speed: f64 = 0.020,
    home_tolerance: f64 = 0.0002,
}

/// Parameters of pressing and sliding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionScanConfig {
    /// Start position of the dome's centre (m, in W).
    pub home: [f64; 3],
    /// Pressing direction (in W); its length does not matter. It need not be exactly perpendicular to the specimen.
    pub approach: [f64; 3],
    /// First sliding direction (in W). Only its component perpendicular to the approach counts, and its length does not
    /// matter.
    pub slide: [f64; 3],
    /// Speed of the approach (m/s).
    #[serde(default = "default::search_speed")]
    pub search_speed: f64,
    /// Maximum travel from home without contact (m). If the finger exceeds it, the hand is stopped.
    #[serde(default = "default::search_limit")]
    pub search_limit: f64,
    /// Pressing force (N).
    #[serde(default = "default::load")]
    pub load: f64,
    /// Pressing speed per missing force (m/(s·N)).
    #[serde(default = "default::load_gain")]
    pub load_gain: f64,
    /// Duration of pressing before sliding (s). The noise of the forces is measured in its second half.
    #[serde(default = "default::settle_time")]
    pub settle_time: f64,
    /// Sliding speed (m/s).
    #[serde(default = "default::slide_speed")]
    pub slide_speed: f64,
    /// Sliding distance of a stroke after the first slip (m).
    #[serde(default = "default::travel")]
    pub travel: f64,
    /// Maximum length of a stroke without a slip (m). If a stroke exceeds it, the task ends.
    #[serde(default = "default::slide_limit")]
    pub slide_limit: f64,
    /// Number of strokes, alternating back and forth, at least 3; the first one is not evaluated.
    #[serde(default = "default::strokes")]
    pub strokes: u32,
    /// Speed of release and return (m/s).
    #[serde(default = "default::return_speed")]
    pub return_speed: f64,
    /// Maximum distance from home for the finger to count as returned (m).
    #[serde(default = "default::home_tolerance")]
    pub home_tolerance: f64,
}

impl FrictionScanConfig {
    /// Checks that every value of the table `key` is in its range, for a control period of `period` seconds.
    /// `thresholds` defines F1 and F2.
    pub fn check(
        &self,
        key: &str,
        period: f64,
        thresholds: &FlagThresholds,
        checker: &mut Checker,
    ) {
        checker.vector(&format!("{key}.home"), self.home);
        checker.direction(&format!("{key}.approach"), self.approach);
        let [approach, slide] =
            [self.approach, self.slide].map(|d| DVec3::from_array(d).normalize_or_zero());
        checker.require(
            &format!("{key}.slide"),
            format!("{:?}", self.slide),
            slide.cross(approach).length() >= libm::sin(MIN_SLIDE.to_radians()),
            &format!(
                "a direction {MIN_SLIDE} degrees or more off {key}.approach = {:?}",
                self.approach
            ),
        );
        let positive = [
            ("search_speed", self.search_speed),
            ("search_limit", self.search_limit),
            ("load_gain", self.load_gain),
            ("slide_speed", self.slide_speed),
            ("travel", self.travel),
            ("slide_limit", self.slide_limit),
            ("return_speed", self.return_speed),
            ("home_tolerance", self.home_tolerance),
        ];
        checker.all_positive(key, &positive);
        let (touch, over) = (thresholds.touch_force, thresholds.over_force);
        checker.require(
            &format!("{key}.load"),
            self.load.to_string(),
            self.load > touch && self.load < over,
            &format!(
                "more than control.touch_force (F1) = {touch}, less than control.over_force (F2) = {over}"
            ),
        );
        let least = MIN_PERIODS_AT_REST * period;
        checker.between(&format!("{key}.settle_time"), self.settle_time, least, 1e3);
        checker.require(
            &format!("{key}.strokes"),
            self.strokes.to_string(),
            (3..=1000).contains(&self.strokes),
            "3 to 1000: one that does not count, one each way",
        );
    }
}
