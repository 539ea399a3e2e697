//! Path of a dome's centre over MOVE, unrolled along the planned line so that bends of a millimetre are visible, with
//! the planned line and the arc about the cap's axis.

use crate::measures::path_fit::{travel, window_rows};
use crate::run::data::RunData;
use crate::run::stroke::Stroke;
use glam::DVec3;

/// One finger's path over one MOVE. The planned line and the arc start on the path at the start of the claims' window.
pub struct Unrolled {
    /// Values at each row of MOVE.
    pub steps: Vec<Step>,
    /// Range of travel evaluated by the claims (m).
    pub window: (f64, f64),
}

/// One row of an [`Unrolled`] path. Values are NaN where the arc does not reach, or if the cap's position is unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Travel along the planned direction since the start of MOVE (m).
    pub travel: f64,
    /// Offset of the path from the planned line (m), positive = towards the cap.
    pub path: f64,
    /// Offset of the arc from the planned line (m), positive = towards the cap.
    pub arc: f64,
    /// R relative to its value at the start of the window (m). R is the horizontal distance of the dome's centre from
    /// the axis.
    pub radius: f64,
    /// Like `radius`, but for the planned line.
    pub line_radius: f64,
    /// Centre of the dome in `W` (m).
    pub centre: DVec3,
    /// Corresponding point on the arc in `W` (m).
    pub on_arc: DVec3,
    /// Corresponding point on the planned line in `W` (m).
    pub on_line: DVec3,
}

impl Unrolled {
    /// Path of `finger` over the MOVE of `stroke`; `None` if the finger does not move.
    pub fn new(data: &RunData, stroke: &Stroke, finger: usize) -> Option<Self> {
        let (direction, approach) = (data.direction(finger)?, data.approach(finger)?);
        let inward = approach.reject_from_normalized(direction).try_normalize()?;
        let rows = stroke.moving.clone();
        let path = data.path(stroke, finger)?;
        let centre = data.cap.as_ref().map(|cap| &cap.centre);
        let axis = |row: usize| {
            let centre = centre.and_then(|centre| centre.get(rows.start + row));
            centre.copied().unwrap_or(DVec3::NAN)
        };
        let travel = travel(path, direction)?;
        let window = window_rows(data, stroke, finger)?;
        let begin = window.first()?.checked_sub(stroke.moving.start)?;
        let end = window.last()?.checked_sub(stroke.moving.start)?;
        let distance = |row: usize, point: DVec3| (point - axis(row)).truncate().length();
        let start = distance(begin, path[begin]);
        let step = |row: usize| {
            let on_line = path[begin] + (travel[row] - travel[begin]) * direction;
            let arc = way_to_circle(on_line - axis(row), inward, start);
            Step {
                travel: travel[row],
                path: (path[row] - path[begin]).dot(inward),
                arc,
                radius: distance(row, path[row]) - start,
                line_radius: distance(row, on_line) - start,
                centre: path[row],
                on_arc: on_line + arc * inward,
                on_line,
            }
        };
        Some(Self {
            steps: (0..path.len()).map(step).collect(),
            window: (travel[begin], travel[end]),
        })
    }

    /// `true` if the arc is known.
    pub fn has_arc(&self) -> bool {
        self.steps.iter().any(|step| step.arc.is_finite())
    }
}

/// Distance along `direction` from a point outside a vertical cylinder about the origin to its near side; NaN if the
/// ray misses the cylinder.
fn way_to_circle(from: DVec3, direction: DVec3, radius: f64) -> f64 {
    let (from, direction) = (from.truncate(), direction.truncate());
    let square = direction.length_squared();
    let half = from.dot(direction);
    let root = half * half - square * (from.length_squared() - radius * radius);
    (-half - root.sqrt()) / square
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ray_ends_on_the_near_side_of_the_circle() {
        for (x, y) in [(0.034, 0.006), (0.031, -0.002), (0.032, 0.0)] {
            let from = DVec3::new(x, y, 0.1);
            let way = way_to_circle(from, DVec3::NEG_X, 0.032);
            let reached = (from + way * DVec3::NEG_X).truncate();
            assert!((reached.length() - 0.032).abs() < 1e-15 && reached.x > 0.0);
        }
        let past = way_to_circle(DVec3::new(0.03, 0.04, 0.0), DVec3::NEG_X, 0.032);
        assert!(past.is_nan());
    }
}
