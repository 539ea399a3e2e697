//! What the carry task is tuned by.

use crate::control::feeler_shape::FeelerShape;
use serde::{Deserialize, Serialize};

/// What is carried where, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CarryConfig {
    /// Speed of the approach, m/s.
    pub search_speed: f64,
    /// A finger that has come this far from home and feels nothing stops the task, m.
    pub search_limit: f64,
    /// Least pressing force of a finger, N: with it the fingers take hold.
    pub grip_force: f64,
    /// Greatest pressing force of a finger, N: more would crush the object.
    pub crush_force: f64,
    /// Pressing force over what would just hold.
    pub margin: f64,
    /// Coefficient of friction that is believed until a slip shows less.
    pub friction: f64,
    /// Elements with a larger force than this count, N.
    pub touch_force: f64,
    /// An element whose shear force changes faster than this does not go with the object, N/s.
    pub slip_threshold: f64,
    /// Speed at which a finger presses harder for each newton that is missing, m/(s N).
    pub force_gain: f64,
    /// Greatest speed of that, m/s.
    pub press_speed: f64,
    /// Speed along the path, m/s.
    pub carry_speed: f64,
    /// Speed at which an error of the object's place is made good, per metre of it, 1/s.
    pub place_gain: f64,
    /// The object is given up where a finger has felt nothing for so long, s…
    pub lost_time: f64,
    /// …and where the fingers have come so much further than where they took it, m, as into nothing.
    pub give: f64,
    /// Speed of release and return, m/s.
    pub return_speed: f64,
    /// A finger is home within this distance, m.
    pub home_tolerance: f64,
    /// The path, from where the object was taken.
    pub waypoint: Vec<Waypoint>,
    /// Each finger's way to the object.
    pub finger: Vec<CarryFinger>,
    /// The feelers of the fingertips.
    pub feeler: FeelerShape,
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
