//! Measures the strokes of a run.

use super::path_fit::{PathFit, window_rows};
use super::paths::inward_bend;
use super::series::{finite, maximum, mean, percentile, standard_deviation};
use super::strokes::{StrokeMeasures, TRUE_SLIP};
use crate::run::data::RunData;
use crate::run::stroke::Stroke;
use glam::DVec3;

impl RunData {
    /// Measures of each stroke.
    pub fn stroke_measures(&self) -> Vec<StrokeMeasures> {
        match &self.thinned {
            Some(thinned) => thinned.strokes.clone(),
            None => {
                let strokes = self.strokes.iter();
                strokes.map(|s| StrokeMeasures::new(self, s)).collect()
            }
        }
    }
}

impl StrokeMeasures {
    /// Measures one stroke.
    pub fn new(data: &RunData, stroke: &Stroke) -> Self {
        let rows = || stroke.rows.clone();
        let moving = || stroke.moving.clone();
        let fits = (0..data.fingers.len()).map(|finger| PathFit::new(data, stroke, finger));
        let fits: Vec<_> = fits.collect();
        let fit = |part: fn(PathFit) -> f64| over_fingers(data, |finger| fits[finger].map(part));
        let of = |measure: Measure| over_fingers(data, |finger| measure(data, stroke, finger));
        Self {
            index: stroke.index,
            peak_torque: (data.has_torque(moving()))
                .then(|| maximum(data.known_torque(rows())))
                .flatten(),
            mean_grasp_force: mean(moving().map(|row| data.grasp_force(row))),
            peak_grasp_force: maximum(rows().map(|row| data.grasp_force(row))),
            cap_turn: cap_turn(data, stroke),
            peak_shear_rate: of(peak_shear_rate),
            slip_fraction: of(slip_fraction),
            slip_precision: of(slip_precision),
            true_slip_fraction: of(true_slip_fraction),
            grasp_force_variation: of(grasp_force_variation),
            over_fraction: of(over_fraction),
            path_inward_bend: path_inward_bend(data, stroke),
            path_radius_std: fit(|fit| fit.radius_std),
            line_radius_std: fit(|fit| fit.line_radius_std),
            path_curvature: fit(|fit| fit.curvature),
            peak_element_force: peak_element_force(data, stroke),
        }
    }
}

/// Measure of the finger with this index over a stroke; `None` if undefined.
type Measure = fn(&RunData, &Stroke, usize) -> Option<f64>;

/// Mean of a measure over fingers; `None` unless every finger defines it.
fn over_fingers(data: &RunData, measure: impl Fn(usize) -> Option<f64>) -> Option<f64> {
    let values: Option<Vec<f64>> = (0..data.fingers.len()).map(measure).collect();
    mean(values?)
}

/// Fraction of values that are `true` (0 to 1).
fn share(values: impl IntoIterator<Item = bool>) -> Option<f64> {
    mean(values.into_iter().map(|value| f64::from(u8::from(value))))
}

/// [`StrokeMeasures::peak_shear_rate`] of one finger.
fn peak_shear_rate(data: &RunData, stroke: &Stroke, finger: usize) -> Option<f64> {
    let rates = &data.fingers[finger].shear_rate;
    percentile(stroke.moving.clone().map(|row| rates[row]), 99.0)
}

/// [`StrokeMeasures::slip_fraction`] of one finger.
pub fn slip_fraction(data: &RunData, stroke: &Stroke, finger: usize) -> Option<f64> {
    let slip = &data.fingers[finger].slip;
    share(stroke.moving.clone().map(|row| slip[row]))
}

/// [`StrokeMeasures::slip_precision`] of one finger.
pub fn slip_precision(data: &RunData, stroke: &Stroke, finger: usize) -> Option<f64> {
    let finger = &data.fingers[finger];
    let raised = stroke.moving.clone().filter(|&row| finger.slip[row]);
    let right = raised.map(|row| Some(finger.slipped[row]? > TRUE_SLIP));
    share(right.collect::<Option<Vec<_>>>()?)
}

/// [`StrokeMeasures::true_slip_fraction`] of one finger.
fn true_slip_fraction(data: &RunData, stroke: &Stroke, finger: usize) -> Option<f64> {
    let slipped = &data.fingers[finger].slipped;
    let slipped = (stroke.moving.clone()).map(|row| Some(slipped[row]? > TRUE_SLIP));
    share(slipped.collect::<Option<Vec<_>>>()?)
}

/// Skill of SLIP in detecting true slip: gain in precision over a random flag, relative to the possible gain. 1 if SLIP
/// is never wrong, 0 if it carries no information.
pub fn slip_skill(data: &RunData, stroke: &Stroke, finger: usize) -> Option<f64> {
    let precision = slip_precision(data, stroke, finger)?;
    let at_random = true_slip_fraction(data, stroke, finger)?;
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
