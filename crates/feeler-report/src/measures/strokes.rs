//! Measures of each stroke. Values are never NaN.

use super::path_fit::{PathFit, window_rows};
use super::paths::inward_bend;
use super::series::{finite, maximum, mean, percentile, standard_deviation};
use crate::run::data::{FingerColumns, RunData, Stroke};
use glam::DVec3;
use serde::Serialize;

/// Anchor displacement per control step above which a feeler counts as slipping (m).
pub const TRUE_SLIP: f64 = 20e-6;

/// Cap rotation relative to the first stroke up to which the cap counts as closed.
pub const CLOSED_TURN: f64 = 0.05;

/// `true` if the last stroke found the cap closed ([`CLOSED_TURN`]), `false` otherwise or if the cap never turned.
/// `turns` are the cap rotations of all strokes (rad).
pub fn found_closed(turns: &[Option<f64>]) -> bool {
    let [first, .., last] = turns else {
        return false;
    };
    first
        .zip(*last)
        .is_some_and(|(first, last)| first > 0.0 && last <= CLOSED_TURN * first)
}

/// `true` if every stroke turned the cap by more than [`CLOSED_TURN`]. `turns` are the cap rotations of all strokes
/// (rad).
pub fn turned(turns: &[Option<f64>]) -> bool {
    let Some(&Some(first)) = turns.first() else {
        return false;
    };
    let least = CLOSED_TURN * first;
    first > 0.0
        && turns
            .iter()
            .all(|turn| turn.is_some_and(|turn| turn > least))
}

/// Measures of one stroke; `None` (JSON null) if the recording does not define them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StrokeMeasures {
    /// Number of the stroke, from 1.
    pub index: u32,
    /// Largest measured torque during the stroke (N·m); `None` unless torque is known throughout MOVE.
    pub peak_torque: Option<f64>,
    /// Grasp force averaged over MOVE and over fingers (N).
    pub mean_grasp_force: Option<f64>,
    /// Maximum over the stroke of the grasp force averaged over fingers (N).
    pub peak_grasp_force: Option<f64>,
    /// Rotation of the cap during the stroke (rad), positive = closing.
    pub cap_turn: Option<f64>,
    /// 99th percentile over MOVE of the shear rate of the element with the largest F_z, averaged over fingers (N/s).
    pub peak_shear_rate: Option<f64>,
    /// Fraction of MOVE with SLIP, averaged over fingers (0 to 1).
    pub slip_fraction: Option<f64>,
    /// Fraction of the control steps of MOVE with SLIP in which a feeler of the finger truly slipped ([`TRUE_SLIP`]),
    /// averaged over fingers (0 to 1); known for simulated runs only.
    pub slip_precision: Option<f64>,
    /// Fraction of MOVE in which a feeler of the finger truly slipped, averaged over fingers (0 to 1). Equals the
    /// precision of a random flag.
    pub true_slip_fraction: Option<f64>,
    /// Standard deviation of the grasp force relative to its mean, within the window of `window_rows`, averaged over
    /// fingers.
    pub grasp_force_variation: Option<f64>,
    /// Fraction of the same window with OVER, averaged over fingers (0 to 1).
    pub over_fraction: Option<f64>,
    /// Largest inward deviation of the fingertip's path over MOVE from the planned straight line, averaged over fingers
    /// (m). See `inward_bend`.
    pub path_inward_bend: Option<f64>,
    /// `PathFit::radius_std`, averaged over fingers (m).
    pub path_radius_std: Option<f64>,
    /// `PathFit::line_radius_std`, averaged over fingers (m).
    pub line_radius_std: Option<f64>,
    /// `PathFit::curvature`, averaged over fingers.
    pub path_curvature: Option<f64>,
    /// Largest F_z of any element during the stroke (N).
    pub peak_element_force: Option<f64>,
}

impl StrokeMeasures {
    /// Measures one stroke.
    pub fn new(data: &RunData, stroke: &Stroke) -> Self {
        let rows = || stroke.rows.clone();
        let moving = || stroke.moving.clone();
        let fits = (0..data.fingers.len()).map(|finger| PathFit::new(data, stroke, finger));
        let fits: Vec<_> = fits.collect();
        let fit = |part: fn(PathFit) -> f64| every_finger(data, |finger| fits[finger].map(part));
        Self {
            index: stroke.index,
            peak_torque: (data.has_torque(moving()))
                .then(|| maximum(data.known_torque(rows())))
                .flatten(),
            mean_grasp_force: mean(moving().map(|row| data.grasp_force(row))),
            peak_grasp_force: maximum(rows().map(|row| data.grasp_force(row))),
            cap_turn: cap_turn(data, stroke),
            peak_shear_rate: over_fingers(data, |finger| {
                percentile(moving().map(|row| finger.shear_rate[row]), 99.0)
            }),
            slip_fraction: over_fingers(data, |finger| share(moving().map(|row| finger.slip[row]))),
            slip_precision: over_fingers(data, |finger| slip_precision(finger, stroke)),
            true_slip_fraction: over_fingers(data, |finger| true_slip_fraction(finger, stroke)),
            grasp_force_variation: every_finger(data, |finger| {
                grasp_force_variation(data, stroke, finger)
            }),
            over_fraction: every_finger(data, |finger| over_fraction(data, stroke, finger)),
            path_inward_bend: path_inward_bend(data, stroke),
            path_radius_std: fit(|fit| fit.radius_std),
            line_radius_std: fit(|fit| fit.line_radius_std),
            path_curvature: fit(|fit| fit.curvature),
            peak_element_force: peak_element_force(data, stroke),
        }
    }
}

impl StrokeMeasures {
    /// Removes all measures except the maxima, for strokes with only extreme rows left.
    pub(crate) fn of_extremes(self) -> Self {
        Self {
            mean_grasp_force: None,
            peak_shear_rate: None,
            slip_fraction: None,
            slip_precision: None,
            true_slip_fraction: None,
            grasp_force_variation: None,
            over_fraction: None,
            path_inward_bend: None,
            path_radius_std: None,
            line_radius_std: None,
            path_curvature: None,
            ..self
        }
    }
}

/// Mean of a measure over fingers; `None` unless every finger defines it.
fn over_fingers(data: &RunData, measure: impl Fn(&FingerColumns) -> Option<f64>) -> Option<f64> {
    every_finger(data, |finger| measure(&data.fingers[finger]))
}

/// Like [`over_fingers`], for a measure that needs the finger's index.
fn every_finger(data: &RunData, measure: impl Fn(usize) -> Option<f64>) -> Option<f64> {
    let values: Option<Vec<f64>> = (0..data.fingers.len()).map(measure).collect();
    mean(values?)
}

/// Fraction of values that are `true` (0 to 1).
pub fn share(values: impl IntoIterator<Item = bool>) -> Option<f64> {
    mean(values.into_iter().map(|value| f64::from(u8::from(value))))
}

/// [`StrokeMeasures::slip_precision`] of one finger.
pub fn slip_precision(finger: &FingerColumns, stroke: &Stroke) -> Option<f64> {
    let raised = stroke.moving.clone().filter(|&row| finger.slip[row]);
    let right = raised.map(|row| Some(finger.slipped[row]? > TRUE_SLIP));
    share(right.collect::<Option<Vec<_>>>()?)
}

/// [`StrokeMeasures::true_slip_fraction`] of one finger.
fn true_slip_fraction(finger: &FingerColumns, stroke: &Stroke) -> Option<f64> {
    let slipped = stroke
        .moving
        .clone()
        .map(|row| Some(finger.slipped[row]? > TRUE_SLIP));
    share(slipped.collect::<Option<Vec<_>>>()?)
}

/// Skill of SLIP in detecting true slip: gain in precision over a random flag, relative to the possible gain. 1 if SLIP
/// is never wrong, 0 if it carries no information.
pub fn slip_skill(finger: &FingerColumns, stroke: &Stroke) -> Option<f64> {
    let (precision, at_random) = (
        slip_precision(finger, stroke)?,
        true_slip_fraction(finger, stroke)?,
    );
    finite((precision - at_random) / (1.0 - at_random))
}

/// [`StrokeMeasures::grasp_force_variation`] of one finger.
pub fn grasp_force_variation(data: &RunData, stroke: &Stroke, finger: usize) -> Option<f64> {
    let rows = window_rows(data, stroke, finger)?;
    let forces = rows
        .iter()
        .map(|&row| data.fingers[finger].grasp_force[row]);
    finite(standard_deviation(forces.clone())? / mean(forces)?)
}

/// [`StrokeMeasures::over_fraction`] of one finger.
pub fn over_fraction(data: &RunData, stroke: &Stroke, finger: usize) -> Option<f64> {
    let rows = window_rows(data, stroke, finger)?.into_iter();
    share(rows.map(|row| data.fingers[finger].over[row]))
}

fn peak_element_force(data: &RunData, stroke: &Stroke) -> Option<f64> {
    let fingers = data.fingers.iter();
    let forces = fingers.flat_map(|finger| &finger.largest_force[stroke.rows.clone()]);
    maximum(forces.copied().filter(|&force| force != f64::NEG_INFINITY))
}

fn cap_turn(data: &RunData, stroke: &Stroke) -> Option<f64> {
    let first = stroke.rows.clone().next()?;
    let last = stroke.rows.clone().next_back()?;
    let angle = &data.cap.as_ref()?.angle;
    finite(angle[last] - angle[first])
}

fn path_inward_bend(data: &RunData, stroke: &Stroke) -> Option<f64> {
    let facts = &data.facts;
    let directions = facts.stroke_direction.iter().zip(&facts.approach);
    let bends: Option<Vec<f64>> = (data.fingers.iter().zip(directions))
        .map(|(finger, (direction, approach))| {
            let path = &finger.position[stroke.moving.clone()];
            inward_bend(path, DVec3::from(*direction), DVec3::from(*approach))
        })
        .collect();
    mean(bends?)
}
