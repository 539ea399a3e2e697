//! Data of the friction figures: the force on the observed element of each stroke, along the axes of the specimen.

use crate::run::data::RunData;
use crate::run::stroke::Stroke;
use feeler_record::FindingName;

/// Force on the observed element at one row (N).
#[derive(Clone, Copy)]
pub struct Sample {
    /// Time (s).
    pub time: f64,
    /// Force on the finger by the specimen, normal to its surface as far as the measured tilt is known.
    pub normal: f64,
    /// Force along the first stroke, positive against its direction.
    pub friction: f64,
    /// Force perpendicular to both.
    pub lateral: f64,
}

impl Sample {
    /// Ratio of friction to normal force.
    pub fn ratio(self) -> f64 {
        self.friction.abs() / self.normal
    }
}

/// Samples of every stroke's MOVE; `None` if the data is missing.
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
    let approach = data.approach(0)?;
    let along = data
        .direction(0)?
        .reject_from_normalized(approach)
        .normalize_or_zero();
    // Axes of the tilted surface.
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
