//! End condition of the screw task, and properties of the cap.

use crate::check::{Checker, MAX};
use crate::control::feeler_shape::FeelerShape;
use serde::{Deserialize, Serialize};

/// Condition that ends the strokes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Until {
    /// After the number of `strokes`.
    #[default]
    Strokes,
    /// When the hand detects that the cap is closed or cannot be closed; at most `strokes` strokes.
    Closed,
    /// When the hand has opened the cap; at most `strokes` strokes.
    Open,
}

defaults! {
    axis: [f64; 2] = [0.0, 0.0],
    damage_force: f64 = 2.5,
    grip_gain: f64 = 0.015,
    clearance: f64 = 0.003,
    still_turn: f64 = 0.05,
    most_friction: f64 = 1.3,
    softest_seat: f64 = 0.0,
    least_turns: f64 = 0.0,
    most_turns: f64 = 1.0,
    open_turns: f64 = 1.0,
}

/// Prior knowledge of a cap, and limits for handling it. The torque that a hand can exert is limited by friction:
/// static coefficient times `grip` times radius times number of fingers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CapConfig {
    /// Assumed position of the axis, x and y (m, in W).
    #[serde(default = "default::axis")]
    pub axis: [f64; 2],
    /// Maximum grip force of each finger towards the axis (N). Gentle strokes use `grasp_force` of the task.
    pub grip: f64,
    /// Force F_z that damages an element if it lasts (N).
    #[serde(default = "default::damage_force")]
    pub damage_force: f64,
    /// Speed towards the axis per missing grip force (m/(s·N)).
    #[serde(default = "default::grip_gain")]
    pub grip_gain: f64,
    /// Distance of a finger from the cap between strokes (m).
    #[serde(default = "default::clearance")]
    pub clearance: f64,
    /// Rotation of the cap below which a stroke counts as not having turned it (rad).
    #[serde(default = "default::still_turn")]
    pub still_turn: f64,
    /// Upper bound of the friction coefficient of any cap. If the tangential force on a finger reaches this coefficient
    /// times the grip force without slip, something other than friction holds the finger, such as knurls. The stroke
    /// then ends, because larger forces would not be measured correctly and a larger torque is not needed.
    #[serde(default = "default::most_friction")]
    pub most_friction: f64,
    /// Minimum torsional stiffness of a seated cap (N·m/rad). If the resistance before standstill is softer, the cap is
    /// not seated.
    #[serde(default = "default::softest_seat")]
    pub softest_seat: f64,
    /// Minimum number of turns of a closed cap. A cap that stops earlier is not closed.
    #[serde(default = "default::least_turns")]
    pub least_turns: f64,
    /// Number of turns after which a cap that still rotates counts as spinning freely.
    #[serde(default = "default::most_turns")]
    pub most_turns: f64,
    /// Number of turns after which a cap counts as open.
    #[serde(default = "default::open_turns")]
    pub open_turns: f64,
    /// Stiffness and tip radius of the columnar feelers, measured on a test bench.
    #[serde(default)]
    pub feeler: FeelerShape,
}

impl CapConfig {
    /// Checks that every value of the table `key` is in its range, and that the grip force is at least `grasp_force`,
    /// which is given with its key.
    pub fn check(&self, key: &str, grasp_force: (&str, f64), checker: &mut Checker) {
        let [x, y] = self.axis;
        checker.vector(&format!("{key}.axis"), [x, y, 0.0]);
        let positive = [
            ("grip_gain", self.grip_gain),
            ("clearance", self.clearance),
            ("still_turn", self.still_turn),
            ("most_friction", self.most_friction),
            ("most_turns", self.most_turns),
            ("open_turns", self.open_turns),
        ];
        checker.all_positive(key, &positive);
        self.feeler.check(&format!("{key}.feeler"), checker);
        checker.not_negative(&format!("{key}.softest_seat"), self.softest_seat);
        let (least_key, least) = grasp_force;
        checker.require(
            &format!("{key}.grip"),
            self.grip.to_string(),
            self.grip >= least && self.grip <= MAX,
            &format!("from {least_key} = {least} to {MAX:e}"),
        );
        checker.positive(&format!("{key}.damage_force"), self.damage_force);
        checker.require(
            &format!("{key}.least_turns"),
            self.least_turns.to_string(),
            (0.0..self.most_turns).contains(&self.least_turns),
            &format!("from 0 to less than {key}.most_turns = {}", self.most_turns),
        );
    }
}
