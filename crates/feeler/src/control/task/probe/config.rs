//! Configuration of the probing routine.

use crate::check::Checker;
use crate::control::flags::FlagThresholds;
use crate::control::task::screw::FingerPathConfig;
use serde::{Deserialize, Serialize};

/// Maximum press force as a fraction of F2; the rest allows for overshoot of drives with lag.
const GREATEST_PRESS: f64 = 0.9;
/// Minimum sine of the angle between approach and stroke directions.
const MIN_CROSS: f64 = 0.1;

/// Places and forces of the probing task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeConfig {
    /// Speed of the approach (m/s).
    #[serde(default = "default::search_speed")]
    pub search_speed: f64,
    /// Maximum travel from home without contact (m), after which the hand is stopped. Also limits the depth of a press.
    #[serde(default = "default::search_limit")]
    pub search_limit: f64,
    /// Speed of the first press and release at each place (m/s). The second press and release are twice as fast.
    #[serde(default = "default::press_speed")]
    pub press_speed: f64,
    /// Force `F_z` to which the most loaded element is pressed (N), at most 0.9 of F2.
    #[serde(default = "default::press_force")]
    pub press_force: f64,
    /// Maximum force `F_z` on the most loaded element while a finger slides (N).
    #[serde(default = "default::slide_force")]
    pub slide_force: f64,
    /// Maximum depth of an element while a finger slides (m). For soft elements, it limits the force to less than
    /// `slide_force`.
    #[serde(default = "default::slide_depth")]
    pub slide_depth: f64,
    /// Sliding distance along the object's axis (m).
    #[serde(default = "default::slide_travel")]
    pub slide_travel: f64,
    /// Distance between neighbouring probing places along the stroke (m).
    #[serde(default = "default::spacing")]
    pub spacing: f64,
    /// Distance from the object at which a finger moves to its next place (m).
    #[serde(default = "default::clearance")]
    pub clearance: f64,
    /// Speed between places and home (m/s).
    #[serde(default = "default::return_speed")]
    pub return_speed: f64,
    /// Minimum and maximum plausible radius of a feeler's rounded tip (m). It cannot be distinguished from the object's
    /// radius by tactile measurements alone.
    #[serde(default = "default::tip_radius")]
    pub tip_radius: [f64; 2],
    /// Home, approach and stroke directions of each finger, as in `[task.screw]`.
    pub finger: Vec<FingerPathConfig>,
}

defaults! {
    search_speed: f64 = 0.004,
    search_limit: f64 = 0.012,
    press_speed: f64 = 0.0015,
    press_force: f64 = 0.35,
    slide_force: f64 = 0.2,
    slide_depth: f64 = 0.0006,
    slide_travel: f64 = 0.005,
    spacing: f64 = 0.003,
    clearance: f64 = 0.002,
    return_speed: f64 = 0.020,
    tip_radius: [f64; 2] = [0.001, 0.0025],
}

impl ProbeConfig {
    /// Returns a probing task with low forces at the home positions of `finger`, for elements rated at `over_force`
    /// (F2, N).
    pub fn gentle(finger: Vec<FingerPathConfig>, over_force: f64) -> Self {
        let press_force = 0.7 * over_force;
        Self {
            search_speed: default::search_speed(),
            search_limit: default::search_limit(),
            press_speed: default::press_speed(),
            press_force,
            slide_force: default::slide_force().min(0.6 * press_force),
            slide_depth: default::slide_depth(),
            slide_travel: default::slide_travel(),
            spacing: default::spacing(),
            clearance: default::clearance(),
            return_speed: default::return_speed(),
            tip_radius: default::tip_radius(),
            finger,
        }
    }

    /// Checks that every value of the table `key` is in its range. `thresholds` defines F1 and F2.
    pub fn check(&self, key: &str, thresholds: &FlagThresholds, checker: &mut Checker) {
        let positive = [
            ("search_speed", self.search_speed),
            ("search_limit", self.search_limit),
            ("press_speed", self.press_speed),
            ("slide_depth", self.slide_depth),
            ("slide_travel", self.slide_travel),
            ("spacing", self.spacing),
            ("clearance", self.clearance),
            ("return_speed", self.return_speed),
        ];
        checker.all_positive(key, &positive);
        let most = GREATEST_PRESS * thresholds.over_force;
        checker.between(
            &format!("{key}.press_force"),
            self.press_force,
            thresholds.touch_force,
            most,
        );
        checker.require(
            &format!("{key}.slide_force"),
            self.slide_force.to_string(),
            self.slide_force > 0.0 && self.slide_force < self.press_force,
            &format!(
                "more than 0 and less than {key}.press_force = {}",
                self.press_force
            ),
        );
        let [least, most] = self.tip_radius;
        checker.require(
            &format!("{key}.tip_radius"),
            format!("{:?}", self.tip_radius),
            least >= 0.0 && most >= least && most.is_finite(),
            "two radii, the smaller one first",
        );
        for (index, finger) in self.finger.iter().enumerate() {
            checker.vector(&format!("{key}.finger[{index}].home"), finger.home);
            let [approach, stroke] = [finger.approach, finger.stroke];
            checker.direction(&format!("{key}.finger[{index}].approach"), approach);
            let cross = glam::DVec3::from_array(approach)
                .normalize_or_zero()
                .cross(glam::DVec3::from_array(stroke).normalize_or_zero());
            checker.require(
                &format!("{key}.finger[{index}].stroke"),
                format!("{stroke:?}"),
                cross.length() >= MIN_CROSS,
                "a direction across the approach",
            );
        }
    }
}
