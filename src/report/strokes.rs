//! What each stroke measures. Every field's definition stands with it; none is ever NaN.

use super::measures::{distance_to_contour, inward_bend};
use super::run_data::{FingerColumns, RunData, Stroke};
use super::series::{finite, maximum, mean, percentile, rms};
use glam::DVec3;
use serde::Serialize;

/// The measures of one stroke; `None` (JSON null) where the recording does not define them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StrokeMeasures {
    /// Number of the stroke, from 1.
    pub index: u32,
    /// Largest measured torque during the stroke, N·m.
    pub peak_torque: Option<f64>,
    /// Grasp force, mean over MOVE and over fingers, N.
    pub mean_grasp_force: Option<f64>,
    /// Largest grasp force during the stroke, of the mean over fingers, N.
    pub peak_grasp_force: Option<f64>,
    /// Angle the cap turned during the stroke, rad, positive = closing.
    pub cap_turn: Option<f64>,
    /// 99th percentile over MOVE of the shear rate of the element of largest F_z, mean over
    /// fingers, N/s.
    pub peak_shear_rate: Option<f64>,
    /// Share of MOVE with SLIP up, mean over fingers, 0 to 1.
    pub slip_fraction: Option<f64>,
    /// Largest inward deviation of the fingertip's path over MOVE from the planned straight
    /// line, mean over fingers, m. See [`inward_bend`].
    pub path_inward_bend: Option<f64>,
    /// RMS over MOVE and fingers of the distance of the leading element's undeformed tip from the
    /// cap's contour, m; the element that leads is that of largest F_z when MOVE begins. See
    /// [`distance_to_contour`].
    pub path_rms_to_contour: Option<f64>,
    /// Largest F_z of any element during the stroke, N.
    pub peak_element_force: Option<f64>,
}

impl StrokeMeasures {
    /// Measures one stroke.
    pub fn new(data: &RunData, stroke: &Stroke) -> Self {
        let rows = || stroke.rows.clone();
        let moving = || stroke.moving.clone();
        Self {
            index: stroke.index,
            peak_torque: maximum(rows().map(|row| data.torque[row])),
            mean_grasp_force: mean(moving().map(|row| data.grasp_force(row))),
            peak_grasp_force: maximum(rows().map(|row| data.grasp_force(row))),
            cap_turn: cap_turn(data, stroke),
            peak_shear_rate: over_fingers(data, |finger| {
                percentile(moving().map(|row| finger.shear_rate[row]), 99.0)
            }),
            slip_fraction: over_fingers(data, |finger| {
                mean(moving().map(|row| f64::from(u8::from(finger.slip[row]))))
            }),
            path_inward_bend: path_inward_bend(data, stroke),
            path_rms_to_contour: path_rms_to_contour(data, stroke),
            peak_element_force: maximum(
                (data.fingers.iter())
                    .flat_map(|finger| rows().flat_map(|row| finger.forces[row].iter()))
                    .map(|force| force.z),
            ),
        }
    }
}

/// Mean over fingers of a measure that every finger must define.
fn over_fingers(data: &RunData, measure: impl Fn(&FingerColumns) -> Option<f64>) -> Option<f64> {
    let values: Option<Vec<f64>> = data.fingers.iter().map(measure).collect();
    mean(values?)
}

fn cap_turn(data: &RunData, stroke: &Stroke) -> Option<f64> {
    let first = stroke.rows.clone().next()?;
    let last = stroke.rows.clone().next_back()?;
    finite(data.cap_angle[last] - data.cap_angle[first])
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

fn path_rms_to_contour(data: &RunData, stroke: &Stroke) -> Option<f64> {
    let (cap, tip_radius) = (data.facts.cap_radius, data.facts.feeler_tip_radius);
    let squares: Option<Vec<f64>> = (data.fingers.iter())
        .map(|finger| {
            let path = finger.leading_path(stroke)?;
            let centres = &data.cap_centre[stroke.moving.clone()];
            let steps = path.iter().zip(centres);
            rms(steps.map(|(&tip, &centre)| distance_to_contour(tip, centre, cap, tip_radius)))
        })
        .collect();
    rms(squares?)
}
