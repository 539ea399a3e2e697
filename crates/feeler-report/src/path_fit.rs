//! How well the path of a fingertip over a stroke fits the arc about the cap's axis.

use super::run_data::{RunData, Stroke};
use super::series::{finite, mean, standard_deviation};
use glam::DVec3;

/// Shares of a stroke's travel between which the grip has built up and the finger is not yet braked.
pub const WINDOW: (f64, f64) = (0.25, 0.98);

/// How well one finger's path over MOVE fits the arc about the cap's axis. Paths are those of the dome's centre, by
/// encoders and kinematics; R is its horizontal distance from the cap's axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathFit {
    /// Standard deviation of R within the [`WINDOW`], m: 0 on an arc about the axis.
    pub radius_std: f64,
    /// The same of the straight line that was planned, from where the finger is when the window begins, m.
    pub line_radius_std: f64,
    /// Curvature of the path relative to that of the arc, 1/R: twice the quadratic coefficient of a least-squares parabola
    /// of the offset towards the cap over the travel, up to the window's end, times the mean R. 1 on the arc, 0 on any
    /// straight line, however tilted.
    pub curvature: f64,
}

impl PathFit {
    /// Of the `finger` over the MOVE of `stroke`; none if it does not travel, or nothing tells where the cap is.
    pub fn new(data: &RunData, stroke: &Stroke, finger: usize) -> Option<Self> {
        let facts = &data.facts;
        let direction = DVec3::from(*facts.stroke_direction.get(finger)?);
        let approach = DVec3::from(*facts.approach.get(finger)?);
        let path = data
            .fingers
            .get(finger)?
            .position
            .get(stroke.moving.clone())?;
        let axis = data.cap.as_ref()?.centre.get(stroke.moving.clone())?;
        Self::of(path, axis, direction, approach)
    }

    /// Of a `path` (m) in the frame of the cap's `axis` (m, a point on it for each of the path's) that was planned along
    /// `direction`, with the cap on the side of `approach`; both are unit vectors.
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

/// The rows of a finger's MOVE that are within the [`WINDOW`].
pub fn window_rows(data: &RunData, stroke: &Stroke, finger: usize) -> Option<Vec<usize>> {
    let direction = DVec3::from(*data.facts.stroke_direction.get(finger)?);
    let path = data
        .fingers
        .get(finger)?
        .position
        .get(stroke.moving.clone())?;
    let rows = window(&travel(path, direction)?)?.into_iter();
    Some(rows.map(|row| stroke.moving.start + row).collect())
}

/// How far along `direction` each point of a path is from its first, m.
pub fn travel(path: &[DVec3], direction: DVec3) -> Option<Vec<f64>> {
    let start = *path.first()?;
    Some(
        path.iter()
            .map(|point| (*point - start).dot(direction))
            .collect(),
    )
}

/// The rows of a path whose travel is within the [`WINDOW`]; none if it goes nowhere.
fn window(travel: &[f64]) -> Option<Vec<usize>> {
    let length = travel.iter().copied().fold(0.0, f64::max);
    let span = WINDOW.0 * length..=WINDOW.1 * length;
    let inside = |row: &usize| span.contains(&travel[*row]);
    (length > 0.0).then(|| (0..travel.len()).filter(inside).collect())
}

/// The coefficient of x² in the parabola that fits (x, y) best; none where they do not define one.
///
/// By polynomials that are orthogonal on the points, so that no system of equations is to be solved.
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

    /// A path about the origin that starts `before` (m) the tangent point and travels 10 mm along y; `sagitta` is the
    /// share of the arc's curvature that it has, `tilt` its slope towards the axis.
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
    fn an_arc_about_the_axis_keeps_its_radius_and_has_its_curvature() {
        for before in [0.0, 0.003, 0.005] {
            let arc = fit(before, 1.0, 0.0);
            assert!(arc.radius_std < 1e-12, "{arc:?}");
            // A parabola follows a circle of 32 mm over 10 mm to the fourth power of 10/32: a few per cent.
            assert!((arc.curvature - 1.0).abs() < 0.06, "{arc:?}");
        }
    }

    /// What once counted as a curve: a straight line that is tilted towards the cap.
    #[test]
    fn a_tilted_straight_line_has_no_curvature() {
        for tilt in [0.0, 0.1, 0.31] {
            let line = fit(0.0, 0.0, tilt);
            assert!(line.curvature.abs() < 1e-9, "{line:?}");
        }
        let planned = fit(0.002, 0.0, 0.0);
        assert!((planned.radius_std - planned.line_radius_std).abs() < 1e-12);
    }

    #[test]
    fn half_a_bend_is_half_the_curvature_and_half_the_deviation() {
        let half = fit(0.0, 0.5, 0.0);
        assert!((half.curvature - 0.5).abs() < 0.03, "{half:?}");
        let share = half.radius_std / half.line_radius_std;
        assert!((share - 0.5).abs() < 0.02, "{half:?}");
    }

    #[test]
    fn a_finger_that_goes_nowhere_has_no_fit() {
        let still = [DVec3::X; 9];
        assert_eq!(
            PathFit::of(&still, &[DVec3::ZERO; 9], DVec3::Y, DVec3::NEG_X),
            None
        );
        assert_eq!(PathFit::of(&[], &[], DVec3::Y, DVec3::NEG_X), None);
    }

    #[test]
    fn a_parabola_gives_its_own_coefficient() {
        let points: Vec<_> = [0.0, 0.1, 0.5, 0.6, 2.0]
            .map(|x| (x, 3.0 - x + 7.0 * x * x))
            .into();
        assert!((quadratic_coefficient(&points).unwrap() - 7.0).abs() < 1e-12);
        assert_eq!(quadratic_coefficient(&points[..2]), None);
    }
}
