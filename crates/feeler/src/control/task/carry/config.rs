//! What the carry task is tuned by.

use crate::check::Checker;
use crate::control::feeler_shape::FeelerShape;
use serde::{Deserialize, Serialize};

/// Most waypoints of a path.
const MAX_WAYPOINTS: usize = 1000;

/// What is carried where, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CarryConfig {
    /// Speed of the approach, m/s.
    #[serde(default = "default::search_speed")]
    pub search_speed: f64,
    /// A finger that has come this far from home and feels nothing stops the task, m.
    #[serde(default = "default::search_limit")]
    pub search_limit: f64,
    /// Least pressing force of a finger, N: with it the fingers take hold.
    pub grip_force: f64,
    /// Greatest pressing force of a finger, N: more would crush the object.
    pub crush_force: f64,
    /// Pressing force over what would just hold.
    #[serde(default = "default::margin")]
    pub margin: f64,
    /// Coefficient of friction that is believed until a slip shows less.
    #[serde(default = "default::friction")]
    pub friction: f64,
    /// Elements with a larger force than this count, N.
    #[serde(default = "default::touch_force")]
    pub touch_force: f64,
    /// An element whose shear force changes faster than this does not go with the object, N/s.
    #[serde(default = "default::slip_threshold")]
    pub slip_threshold: f64,
    /// Speed at which a finger presses harder for each newton that is missing, m/(s N).
    #[serde(default = "default::force_gain")]
    pub force_gain: f64,
    /// Greatest speed of that, m/s.
    #[serde(default = "default::press_speed")]
    pub press_speed: f64,
    /// Speed along the path, m/s.
    #[serde(default = "default::carry_speed")]
    pub carry_speed: f64,
    /// Speed at which an error of the object's place is made good, per metre of it, 1/s.
    #[serde(default = "default::place_gain")]
    pub place_gain: f64,
    /// The object is given up where a finger has felt nothing for so long, s…
    #[serde(default = "default::lost_time")]
    pub lost_time: f64,
    /// …and where the fingers have come so much further than where they took it, m, as into nothing.
    #[serde(default = "default::give")]
    pub give: f64,
    /// Speed of release and return, m/s.
    #[serde(default = "default::return_speed")]
    pub return_speed: f64,
    /// A finger is home within this distance, m.
    #[serde(default = "default::home_tolerance")]
    pub home_tolerance: f64,
    /// The path, from where the object was taken.
    pub waypoint: Vec<Waypoint>,
    /// Each finger's way to the object.
    pub finger: Vec<CarryFinger>,
    /// The feelers of the fingertips.
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

/// A place on the way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// How far from where it was taken, m, in W.
    pub to: [f64; 3],
    /// How long the object is held there, s.
    #[serde(default)]
    pub hold: f64,
}

/// One finger's way to the object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CarryFinger {
    /// Where the dome's centre starts from, m, in W.
    pub home: [f64; 3],
    /// Direction in which it presses, in W; its length does not matter.
    pub approach: [f64; 3],
}

impl CarryConfig {
    /// Requires every value of the table `key` to be in its range.
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
