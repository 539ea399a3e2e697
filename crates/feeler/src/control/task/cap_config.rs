//! When a cap is done with, and what is known of it beforehand.

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

/// What is known of a cap before it is touched, and how it may be treated. The torque that a hand can put on it is limited by friction:
/// static coefficient times `grip` times radius times fingers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CapConfig {
    /// Where its axis is thought to be, x and y, m, in W.
    pub axis: [f64; 2],
    /// Grip force allowed, of each finger towards the axis, N; `grasp_force` of the task is that of gentle strokes.
    pub grip: f64,
    /// Force F_z on an element that damages it if it stays, N.
    pub damage_force: f64,
    /// Speed towards the axis for each newton of grip that is missing, m/s/N.
    pub grip_gain: f64,
    /// How far a finger goes off the cap between strokes, m.
    pub clearance: f64,
    /// A stroke that turns the cap less than this, rad, has not turned it.
    pub still_turn: f64,
    /// No cap has more friction than this. Where a finger drags harder without slipping, something else holds it, as
    /// knurls do, and it drags no further: more force would not be measured rightly, and nobody asked for the torque.
    pub most_friction: f64,
    /// What resists a cap before it stands still is no seat if it is softer than this, N·m/rad.
    #[serde(default)]
    pub softest_seat: f64,
    /// A cap that stands still before so many turns is not closed.
    #[serde(default)]
    pub least_turns: f64,
    /// A cap that still turns after so many turns never tightens.
    #[serde(default = "one")]
    pub most_turns: f64,
    /// A cap that is to be opened is open after so many turns; until then, it does not matter.
    #[serde(default = "one")]
    pub open_turns: f64,
    /// The feelers, as measured on a bench.
    pub feeler: FeelerShape,
}

fn one() -> f64 {
    1.0
}
