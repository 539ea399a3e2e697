//! What a friction scan is tuned by.

use crate::check::Checker;
use crate::control::flags::FlagThresholds;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Sliding and pressing are this far apart at least, degrees.
const MIN_SLIDE: f64 = 5.0;
/// Control periods that a friction scan settles for at least: half of them tell the noise.
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

/// Where the finger presses and how it slides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionScanConfig {
    /// Where the dome's centre starts from, m, in W.
    pub home: [f64; 3],
    /// Direction in which the finger presses, in W; its length does not matter. The specimen need not face it exactly.
    pub approach: [f64; 3],
    /// Direction in which it slides first, in W; only what is across the approach counts, and not its length.
    pub slide: [f64; 3],
    /// Speed of the approach, m/s.
    #[serde(default = "default::search_speed")]
    pub search_speed: f64,
    /// A finger that has come this far from home and feels no specimen stops the task, m.
    #[serde(default = "default::search_limit")]
    pub search_limit: f64,
    /// Force with which it presses, N.
    #[serde(default = "default::load")]
    pub load: f64,
    /// Speed at which it presses harder for each newton that is missing, m/(s N).
    #[serde(default = "default::load_gain")]
    pub load_gain: f64,
    /// How long it presses before it slides, s; the noise of its forces is measured in the second half.
    #[serde(default = "default::settle_time")]
    pub settle_time: f64,
    /// Speed of sliding, m/s.
    #[serde(default = "default::slide_speed")]
    pub slide_speed: f64,
    /// How far it slides in a stroke after the first slip, m.
    #[serde(default = "default::travel")]
    pub travel: f64,
    /// A stroke that has come this far without a slip ends the task, m.
    #[serde(default = "default::slide_limit")]
    pub slide_limit: f64,
    /// Strokes, back and forth in turn, at least 3: the first one does not count.
    #[serde(default = "default::strokes")]
    pub strokes: u32,
    /// Speed of release and return, m/s.
    #[serde(default = "default::return_speed")]
    pub return_speed: f64,
    /// The finger is home within this distance, m.
    #[serde(default = "default::home_tolerance")]
    pub home_tolerance: f64,
}

impl FrictionScanConfig {
    /// Requires every value of the table `key` to be in its range, with a control period of `period` seconds; elements touch
    /// and are pressed enough as the `thresholds` say.
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
            slide.cross(approach).length() >= MIN_SLIDE.to_radians().sin(),
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
