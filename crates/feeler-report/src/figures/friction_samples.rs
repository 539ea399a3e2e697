//! What the figures of a friction scan are drawn from: the force on the element that each stroke looks at, along the
//! axes of the specimen.

use crate::run_data::{RunData, Stroke};
use feeler_record::FindingName;
use glam::DVec3;

/// The force on the element at one row, N.
#[derive(Clone, Copy)]
pub struct Sample {
    /// s.
    pub time: f64,
    /// On the finger by the specimen, across its surface as far as the found tilt tells.
    pub normal: f64,
    /// Along the first stroke, against it.
    pub friction: f64,
    /// Across both.
    pub lateral: f64,
}

impl Sample {
    /// Friction by normal force.
    pub fn ratio(self) -> f64 {
        self.friction.abs() / self.normal
    }
}

/// The samples of every stroke's MOVE.
pub fn strokes(data: &RunData) -> Option<Vec<Vec<Sample>>> {
    let strokes: Option<Vec<_>> = data
        .strokes
        .iter()
        .map(|stroke| samples(data, stroke))
        .collect();
    strokes.filter(|strokes| strokes.iter().any(|samples| !samples.is_empty()))
}

fn samples(data: &RunData, stroke: &Stroke) -> Option<Vec<Sample>> {
    let finger = data.fingers.first()?;
    let approach = DVec3::from(*data.facts.approach.first()?);
    let along = DVec3::from(*data.facts.stroke_direction.first()?);
    let along = along.reject_from_normalized(approach).normalize_or_zero();
    // The axes of a surface that is tilted so.
    let (sin, cos) = data
        .findings
        .get(&FindingName::Tilt)
        .copied()
        .unwrap_or(0.0)
        .sin_cos();
    let normal = -cos * approach - sin * along;
    let against = sin * approach - cos * along;
    let across = normal.cross(against);
    let rows = stroke.moving.clone();
    let element = rows.clone().find_map(|row| finger.largest_element[row]);
    let Some(element) = element else {
        return Some(Vec::new());
    };
    let sample = |row: usize| {
        let force = finger.force_in_world(row, element)?;
        Some(Sample {
            time: data.time[row],
            normal: force.dot(normal),
            friction: force.dot(against),
            lateral: force.dot(across),
        })
    };
    let touching = |sample: &Sample| sample.normal > 0.5 * data.facts.touch_force_threshold;
    Some(rows.filter_map(sample).filter(touching).collect())
}
