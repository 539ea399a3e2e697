//! Fit of a fingertip's path over a stroke to the arc about the cap's axis.

use super::series::{finite, mean, standard_deviation};
use crate::run::data::RunData;
use crate::run::stroke::Stroke;
use glam::DVec3;

/// Range of a stroke's travel (as fractions) in which the grip has built up and the finger does not brake yet.
pub const WINDOW: (f64, f64) = (0.25, 0.98);

/// Fit of one finger's path over MOVE to the arc about the cap's axis. The path is that of the dome's centre, from
/// encoders and kinematics. R is its horizontal distance from the cap's axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathFit {
    /// Standard deviation of R within the [`WINDOW`] (m); 0 on an arc about the axis.
    pub radius_std: f64,
    /// Standard deviation of R on the planned straight line, starting at the finger's position at the start of the
    /// window (m).
    pub line_radius_std: f64,
    /// Curvature of the path relative to the curvature 1/R of the arc: mean R times twice the quadratic coefficient of
    /// a least-squares parabola of the inward offset over the travel, up to the end of the window. 1 on the arc, 0 on
    /// any straight line, however tilted.
    pub curvature: f64,
}

impl PathFit {
    /// Fit of `finger` over the MOVE of `stroke`; `None` if the finger does not move or the cap's position is unknown.
    pub fn new(data: &RunData, stroke: &Stroke, finger: usize) -> Option<Self> {
        let (direction, approach) = (data.direction(finger)?, data.approach(finger)?);
        let axis = data.cap.as_ref()?.centre.get(stroke.moving.clone())?;
        Self::of(data.path(stroke, finger)?, axis, direction, approach)
    }

    /// Fit of a `path` (m). `axis` contains a point of the cap's axis (m) for each point of the path. The path was
    /// planned along `direction`; the cap is on the side of `approach`. Both are unit vectors.
    pub fn of(path: &[DVec3], axis: &[DVec3], direction: DVec3, approach: DVec3) -> Option<Self> {
        if axis.len() != path.len() {
            return None;
        }
        let travel = travel(path, direction)?;
        let rows = window(&travel)?;
        let (first, last) = (*rows.first()?, *rows.last()?);
        let radius = |row: usize, point: DVec3| (point - axis[row]).truncate().length();
        let along = |row: usize| radius(row, path[row]);
        let planned = |row: usize| {
            let line = path[first] + (travel[row] - travel[first]) * direction;
            radius(row, line)
        };
        let inward = approach.reject_from_normalized(direction).try_normalize()?;
        let offsets = (0..=last).map(|row| (travel[row], (path[row] - path[0]).dot(inward)));
        let bend = quadratic_coefficient(&offsets.collect::<Vec<_>>())?;
        let mean_radius = mean((0..=last).map(along))?;
        Some(Self {
            radius_std: standard_deviation(rows.iter().map(|&row| along(row)))?,
            line_radius_std: standard_deviation(rows.iter().map(|&row| planned(row)))?,
            curvature: finite(2.0 * bend * mean_radius)?,
        })
    }
}

/// Rows of a finger's MOVE within the [`WINDOW`].
pub fn window_rows(data: &RunData, stroke: &Stroke, finger: usize) -> Option<Vec<usize>> {
    let travel = travel(data.path(stroke, finger)?, data.direction(finger)?)?;
    let rows = window(&travel)?.into_iter();
    Some(rows.map(|row| stroke.moving.start + row).collect())
}

/// Travel of each point of a path along `direction`, relative to the first point (m).
pub fn travel(path: &[DVec3], direction: DVec3) -> Option<Vec<f64>> {
    let start = *path.first()?;
    Some(
        path.iter()
            .map(|point| (*point - start).dot(direction))
            .collect(),
    )
}

/// Rows of a path whose travel is within the [`WINDOW`]; `None` if the path has no length.
fn window(travel: &[f64]) -> Option<Vec<usize>> {
    let length = travel.iter().copied().fold(0.0, f64::max);
    let span = WINDOW.0 * length..=WINDOW.1 * length;
    let inside = |row: &usize| span.contains(&travel[*row]);
    (length > 0.0).then(|| (0..travel.len()).filter(inside).collect())
}

/// Coefficient of x² of the parabola that fits (x, y) best; `None` if the points do not define it.
///
/// Uses polynomials that are orthogonal on the points, so that no system of equations has to be solved.
fn quadratic_coefficient(points: &[(f64, f64)]) -> Option<f64> {
    let middle = mean(points.iter().map(|p| p.0))?;
    let centred = || points.iter().map(|p| p.0 - middle);
    let square = mean(centred().map(|x| x * x))?;
    let skew = mean(centred().map(|x| x.powi(3)))?;
    let second = |x: f64| x * x - square - x * skew / square;
    let norm = centred().map(|x| second(x).powi(2)).sum::<f64>();
    let share: f64 = centred().zip(points).map(|(x, p)| second(x) * p.1).sum();
    finite(share / norm)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS: f64 = 0.032;

    /// Fit of a path about the origin that starts `before` (m) the tangent point and travels 10 mm along y. `sagitta`
    /// is its curvature relative to the arc, `tilt` its slope towards the axis.
    fn fit(before: f64, sagitta: f64, tilt: f64) -> PathFit {
        let points = (0..=200).map(|i| {
            let y = -before + 5e-5 * f64::from(i);
            let arc = (RADIUS * RADIUS - y * y).sqrt();
            DVec3::new(
                RADIUS + sagitta * (arc - RADIUS) - tilt * (y + before),
                y,
                0.1,
            )
        });
        let path: Vec<_> = points.collect();
        PathFit::of(&path, &[DVec3::ZERO; 201], DVec3::Y, DVec3::NEG_X).unwrap()
    }

    #[test]
    fn arc_about_the_axis_has_constant_radius_and_curvature_1() {
        for before in [0.0, 0.003, 0.005] {
            let arc = fit(before, 1.0, 0.0);
            assert!(arc.radius_std < 1e-12, "{arc:?}");
            // Over 10 mm, a parabola deviates from a circle of 32 mm by the fourth power of 10/32: a few percent.
            assert!((arc.curvature - 1.0).abs() < 0.06, "{arc:?}");
        }
    }

    /// Regression: a straight line tilted towards the cap was measured as curved.
    #[test]
    fn tilted_straight_line_has_no_curvature() {
        for tilt in [0.0, 0.1, 0.31] {
            let line = fit(0.0, 0.0, tilt);
            assert!(line.curvature.abs() < 1e-9, "{line:?}");
        }
        let planned = fit(0.002, 0.0, 0.0);
        assert!((planned.radius_std - planned.line_radius_std).abs() < 1e-12);
    }

    #[test]
    fn half_the_sagitta_is_half_the_curvature_and_deviation() {
        let half = fit(0.0, 0.5, 0.0);
        assert!((half.curvature - 0.5).abs() < 0.03, "{half:?}");
        let share = half.radius_std / half.line_radius_std;
        assert!((share - 0.5).abs() < 0.02, "{half:?}");
    }

    #[test]
    fn stationary_finger_has_no_fit() {
        let still = [DVec3::X; 9];
        assert_eq!(
            PathFit::of(&still, &[DVec3::ZERO; 9], DVec3::Y, DVec3::NEG_X),
            None
        );
        assert_eq!(PathFit::of(&[], &[], DVec3::Y, DVec3::NEG_X), None);
    }

    #[test]
    fn quadratic_coefficient_of_a_parabola_is_exact() {
        let points: Vec<_> = [0.0, 0.1, 0.5, 0.6, 2.0]
            .map(|x| (x, 3.0 - x + 7.0 * x * x))
            .into();
        assert!((quadratic_coefficient(&points).unwrap() - 7.0).abs() < 1e-12);
        assert_eq!(quadratic_coefficient(&points[..2]), None);
    }
}
