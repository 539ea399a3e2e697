//! When a cap is done with, and what is known of it beforehand.

use crate::check::{Checker, MAX};
use crate::control::feeler_shape::FeelerShape;
use serde::{Deserialize, Serialize};

/// When the strokes end.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Until {
    /// After as many as `strokes` says.
    #[default]
    Strokes,
    /// When the hand feels that the cap is closed, or what keeps it from being so; after `strokes` at most.
    Closed,
    /// When the hand has turned the cap open; after `strokes` at most.
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

/// What is known of a cap before it is touched, and how it may be treated. The torque that a hand can put on it is limited by friction:
/// static coefficient times `grip` times radius times fingers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CapConfig {
    /// Where its axis is thought to be, x and y, m, in W.
    #[serde(default = "default::axis")]
    pub axis: [f64; 2],
    /// Grip force allowed, of each finger towards the axis, N; `grasp_force` of the task is that of gentle strokes.
    pub grip: f64,
    /// Force F_z on an element that damages it if it stays, N.
    #[serde(default = "default::damage_force")]
    pub damage_force: f64,
    /// Speed towards the axis for each newton of grip that is missing, m/s/N.
    #[serde(default = "default::grip_gain")]
    pub grip_gain: f64,
    /// How far a finger goes off the cap between strokes, m.
    #[serde(default = "default::clearance")]
    pub clearance: f64,
    /// A stroke that turns the cap less than this, rad, has not turned it.
    #[serde(default = "default::still_turn")]
    pub still_turn: f64,
    /// No cap has more friction than this. Where a finger drags harder without slipping, something else holds it, as
    /// knurls do, and it drags no further: more force would not be measured rightly, and nobody asked for the torque.
    #[serde(default = "default::most_friction")]
    pub most_friction: f64,
    /// What resists a cap before it stands still is no seat if it is softer than this, N·m/rad.
    #[serde(default = "default::softest_seat")]
    pub softest_seat: f64,
    /// A cap that stands still before so many turns is not closed.
    #[serde(default = "default::least_turns")]
    pub least_turns: f64,
    /// A cap that still turns after so many turns never tightens.
    #[serde(default = "default::most_turns")]
    pub most_turns: f64,
    /// A cap that is to be opened is open after so many turns; until then, it does not matter.
    #[serde(default = "default::open_turns")]
    pub open_turns: f64,
    /// The feelers, as measured on a bench.
    #[serde(default)]
    pub feeler: FeelerShape,
}

impl CapConfig {
    /// Requires every value of the table `key` to be in its range, and the grip to be at least the `grasp_force`, which
    /// comes with its key.
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
