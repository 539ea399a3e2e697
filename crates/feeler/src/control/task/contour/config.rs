//! Configuration of the contour task.

use crate::check::Checker;
use crate::control::feeler_shape::FeelerShape;
use serde::{Deserialize, Serialize};

/// Parameters of the finger's motion around the object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContourConfig {
    /// Start position of the dome's centre (m, in W). The finger keeps this height.
    pub home: [f64; 3],
    /// Horizontal search direction (in W); its length does not matter.
    pub approach: [f64; 3],
    /// Speed of the approach (m/s).
    #[serde(default = "default::search_speed")]
    pub search_speed: f64,
    /// Maximum travel from home without contact (m). If the finger exceeds it, the hand is stopped.
    #[serde(default = "default::search_limit")]
    pub search_limit: f64,
    /// Speed along the surface (m/s).
    #[serde(default = "default::follow_speed")]
    pub follow_speed: f64,
    /// Horizontal contact force to be maintained (N).
    #[serde(default = "default::contact_force")]
    pub contact_force: f64,
    /// Force above which an element is in contact (N).
    #[serde(default = "default::touch_force")]
    pub touch_force: f64,
    /// Pressing speed per missing force (m/(s·N)).
    #[serde(default = "default::force_gain")]
    pub force_gain: f64,
    /// Maximum speed of pressing or retreating (m/s).
    #[serde(default = "default::press_speed")]
    pub press_speed: f64,
    /// Adaptation rate of the friction angle per force error (rad/(s·N)).
    #[serde(default = "default::friction_gain")]
    pub friction_gain: f64,
    /// Maximum distance from the first point for the outline to count as closed (m).
    #[serde(default = "default::closing_distance")]
    pub closing_distance: f64,
    /// Duration without contact after which the task fails (s).
    #[serde(default = "default::lost_time")]
    pub lost_time: f64,
    /// Maximum duration of following the surface (s); then the task fails.
    #[serde(default = "default::follow_limit")]
    pub follow_limit: f64,
    /// Distance by which the finger retracts from the object before it returns (m).
    #[serde(default = "default::clearance")]
    pub clearance: f64,
    /// Speed of release and return (m/s).
    #[serde(default = "default::return_speed")]
    pub return_speed: f64,
    /// Maximum distance from home for the finger to count as returned (m).
    #[serde(default = "default::home_tolerance")]
    pub home_tolerance: f64,
    /// Mechanical properties of the feelers (rubber columns of the sensing elements).
    #[serde(default)]
    pub feeler: FeelerShape,
}

defaults! {
    search_speed: f64 = 0.004,
    search_limit: f64 = 0.050,
    follow_speed: f64 = 0.006,
    contact_force: f64 = 0.5,
    touch_force: f64 = 0.02,
    force_gain: f64 = 0.03,
    press_speed: f64 = 0.02,
    friction_gain: f64 = 0.5,
    closing_distance: f64 = 0.001,
    lost_time: f64 = 1.0,
    follow_limit: f64 = 90.0,
    clearance: f64 = 0.005,
    return_speed: f64 = 0.020,
    home_tolerance: f64 = 0.0002,
}

impl ContourConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.vector(&format!("{key}.home"), self.home);
        let [x, y, _] = self.approach;
        checker.direction(&format!("{key}.approach"), [x, y, 0.0]);
        let positive = [
            ("search_speed", self.search_speed),
            ("search_limit", self.search_limit),
            ("follow_speed", self.follow_speed),
            ("touch_force", self.touch_force),
            ("force_gain", self.force_gain),
            ("press_speed", self.press_speed),
            ("closing_distance", self.closing_distance),
            ("lost_time", self.lost_time),
            ("follow_limit", self.follow_limit),
            ("clearance", self.clearance),
            ("return_speed", self.return_speed),
            ("home_tolerance", self.home_tolerance),
        ];
        checker.all_positive(key, &positive);
        checker.not_negative(&format!("{key}.friction_gain"), self.friction_gain);
        let contact_force = ("contact_force", self.contact_force);
        checker.more_than(key, contact_force, ("touch_force", self.touch_force));
        self.feeler.check(&format!("{key}.feeler"), checker);
    }
}
