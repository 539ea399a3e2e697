//! Configuration of the carry task.

use crate::check::Checker;
use crate::control::feeler_shape::FeelerShape;
use serde::{Deserialize, Serialize};

/// Maximum number of waypoints of a path.
const MAX_WAYPOINTS: usize = 1000;

/// Path of the carried object and parameters of the grip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CarryConfig {
    /// Speed of the approach (m/s).
    #[serde(default = "default::search_speed")]
    pub search_speed: f64,
    /// Maximum travel from home without contact (m). If a finger exceeds it, the hand is stopped.
    #[serde(default = "default::search_limit")]
    pub search_limit: f64,
    /// Minimum pressing force of a finger (N), with which the fingers grasp the object.
    pub grip_force: f64,
    /// Maximum pressing force of a finger (N), above which the object would be crushed.
    pub crush_force: f64,
    /// Ratio of the pressing force to the minimum that holds the object.
    #[serde(default = "default::margin")]
    pub margin: f64,
    /// Initial estimate of the friction coefficient, used until a slip indicates a lower one.
    #[serde(default = "default::friction")]
    pub friction: f64,
    /// Force above which an element is in contact (N).
    #[serde(default = "default::touch_force")]
    pub touch_force: f64,
    /// Shear rate above which an element counts as moving relative to the object (N/s).
    #[serde(default = "default::slip_threshold")]
    pub slip_threshold: f64,
    /// Pressing speed per missing force (m/(s·N)).
    #[serde(default = "default::force_gain")]
    pub force_gain: f64,
    /// Maximum pressing speed (m/s).
    #[serde(default = "default::press_speed")]
    pub press_speed: f64,
    /// Speed along the path (m/s).
    #[serde(default = "default::carry_speed")]
    pub carry_speed: f64,
    /// Correction speed per position error of the object (1/s).
    #[serde(default = "default::place_gain")]
    pub place_gain: f64,
    /// Duration without contact of a finger after which the object counts as lost (s).
    #[serde(default = "default::lost_time")]
    pub lost_time: f64,
    /// Maximum distance by which the fingers may close further than at the first grasp (m). Beyond it, the object
    /// counts as lost.
    #[serde(default = "default::give")]
    pub give: f64,
    /// Speed of release and return (m/s).
    #[serde(default = "default::return_speed")]
    pub return_speed: f64,
    /// Maximum distance from home for a finger to count as returned (m).
    #[serde(default = "default::home_tolerance")]
    pub home_tolerance: f64,
    /// Waypoints of the path, relative to the position at which the object was grasped.
    pub waypoint: Vec<Waypoint>,
    /// Start position and approach of each finger.
    pub finger: Vec<CarryFinger>,
    /// Mechanical properties of the feelers (rubber columns of the sensing elements).
    #[serde(default)]
    pub feeler: FeelerShape,
}

defaults! {
    search_speed: f64 = 0.006,
    search_limit: f64 = 0.020,
    margin: f64 = 1.3,
    friction: f64 = 0.8,
    touch_force: f64 = 0.05,
    slip_threshold: f64 = 12.0,
    force_gain: f64 = 0.005,
    press_speed: f64 = 0.02,
    carry_speed: f64 = 0.010,
    place_gain: f64 = 2.0,
    lost_time: f64 = 0.3,
    give: f64 = 0.004,
    return_speed: f64 = 0.020,
    home_tolerance: f64 = 0.0002,
}

/// A waypoint of the path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// Displacement from the position at which the object was grasped (m, in W).
    pub to: [f64; 3],
    /// Duration for which the object is held at the waypoint (s).
    #[serde(default)]
    pub hold: f64,
}

/// Start position and approach of one finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CarryFinger {
    /// Start position of the dome's centre (m, in W).
    pub home: [f64; 3],
    /// Pressing direction (in W); its length does not matter.
    pub approach: [f64; 3],
}

impl CarryConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let positive = [
            ("search_speed", self.search_speed),
            ("search_limit", self.search_limit),
            ("friction", self.friction),
            ("touch_force", self.touch_force),
            ("slip_threshold", self.slip_threshold),
            ("force_gain", self.force_gain),
            ("press_speed", self.press_speed),
            ("carry_speed", self.carry_speed),
            ("lost_time", self.lost_time),
            ("give", self.give),
            ("return_speed", self.return_speed),
            ("home_tolerance", self.home_tolerance),
        ];
        checker.all_positive(key, &positive);
        checker.between(&format!("{key}.margin"), self.margin, 1.0, 10.0);
        checker.not_negative(&format!("{key}.place_gain"), self.place_gain);
        let grip_force = ("grip_force", self.grip_force);
        checker.more_than(key, grip_force, ("touch_force", self.touch_force));
        checker.more_than(key, ("crush_force", self.crush_force), grip_force);
        checker.require(
            &format!("{key}.waypoint"),
            format!("{} waypoints", self.waypoint.len()),
            (1..=MAX_WAYPOINTS).contains(&self.waypoint.len()),
            &format!("1 to {MAX_WAYPOINTS} waypoints"),
        );
        for (index, waypoint) in self.waypoint.iter().enumerate() {
            checker.vector(&format!("{key}.waypoint[{index}].to"), waypoint.to);
            checker.not_negative(&format!("{key}.waypoint[{index}].hold"), waypoint.hold);
        }
        for (index, finger) in self.finger.iter().enumerate() {
            checker.vector(&format!("{key}.finger[{index}].home"), finger.home);
            checker.direction(&format!("{key}.finger[{index}].approach"), finger.approach);
        }
        self.feeler.check(&format!("{key}.feeler"), checker);
    }
}
