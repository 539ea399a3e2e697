//! Estimates the surface of an object at a contact from the positions of the loaded feeler tips.

use crate::control::feeler_shape::FeelerShape;
use crate::control::sense::FingerReadings;
use glam::DVec3;
use nalgebra::{SMatrix, SVector};

/// Length unit of the coordinates in the fit (m), so that all terms have similar magnitudes.
const UNIT: f64 = 1e-3;
/// Standard deviation of the position of a tip (m).
const TIP_ERROR: f64 = 1e-5;
/// Prior standard deviation of the slope of an object's surface. With few tips, it makes the estimate as flat as their
/// positions permit.
const SLOPE_DEVIATION: f64 = 1.0;
/// Prior standard deviation of the curvature of an object's surface (1/m).
const CURVATURE_DEVIATION: f64 = 300.0;

/// Surface of an object: depth along the closing direction, as a second-order polynomial in the coordinates
/// perpendicular to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    /// Closing direction, a unit vector in W.
    approach: DVec3,
    /// Axes perpendicular to the closing direction, unit vectors in W.
    across: [DVec3; 2],
    /// Origin of the coordinates (m, in W).
    origin: DVec3,
    /// Coefficients of 1, x, y, x²/2, xy and y²/2, in units of [`UNIT`].
    coefficients: SVector<f64, 6>,
}

impl Surface {
    /// Fits the surface to the tips of `finger` that press along `approach` with more than `least` (N), weighted by
    /// their force. `feeler` contains the properties of the feelers in series with the object. `None` if no tip
    /// presses.
    pub fn fit(
        finger: &FingerReadings<'_>,
        approach: DVec3,
        feeler: &FeelerShape,
        least: f64,
    ) -> Option<Self> {
        let elements = 0..finger.touch.frame.forces.len();
        let pressed = elements.filter_map(|element| {
            let force = finger.force(element);
            let pressing = -force.dot(approach);
            let tip = feeler.tip(finger, element, force)?;
            (pressing > least).then_some((tip, pressing))
        });
        let origin = finger.pose.position + finger.layout.dome_radius * approach;
        Self::through(pressed, origin, approach)
    }

    /// Fits the surface to `points` (m, in W) with their weights, in coordinates from `origin` (m, in W).
    fn through(
        points: impl Iterator<Item = (DVec3, f64)>,
        origin: DVec3,
        approach: DVec3,
    ) -> Option<Self> {
        let mut surface = Self {
            approach,
            across: approach.any_orthonormal_pair().into(),
            origin,
            coefficients: SVector::zeros(),
        };
        let mut matrix = SMatrix::<f64, 6, 6>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        let mut total = 0.0;
        for (point, weight) in points {
            let [x, y] = surface.coordinates(point);
            let depth = (point - origin).dot(approach) / UNIT;
            let row = SVector::from([1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y]);
            matrix += weight * row * row.transpose();
            right += weight * depth * row;
            total += weight;
        }
        let prior = |deviation: f64| {
            let ratio = TIP_ERROR / UNIT / deviation;
            total * ratio * ratio
        };
        let [slope, curvature] = [SLOPE_DEVIATION, CURVATURE_DEVIATION * UNIT].map(prior);
        matrix += SMatrix::from_diagonal(&SVector::from([
            0.0, slope, slope, curvature, curvature, curvature,
        ]));
        surface.coefficients = matrix.cholesky()?.solve(&right);
        Some(surface)
    }

    /// Coordinates of `position` (m, in W) perpendicular to the closing direction, in units of [`UNIT`].
    fn coordinates(&self, position: DVec3) -> [f64; 2] {
        self.across
            .map(|axis| (position - self.origin).dot(axis) / UNIT)
    }

    /// Surface normal at `position` (m, in W), a unit vector in W that points into the object.
    pub fn normal(&self, position: DVec3) -> DVec3 {
        let [x, y] = self.coordinates(position);
        let c = &self.coefficients;
        let [along_x, along_y] = [c[1] + c[3] * x + c[4] * y, c[2] + c[4] * x + c[5] * y];
        let [across_x, across_y] = self.across;
        (self.approach - along_x * across_x - along_y * across_y).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points 2 mm apart within 4 mm of the closing direction along x.
    fn grid() -> impl Iterator<Item = [f64; 2]> {
        let places = (-2..=2).map(|n| 2e-3 * f64::from(n));
        let other = places.clone();
        places.flat_map(move |y| other.clone().map(move |z| [y, z]))
    }

    fn fitted(points: impl Iterator<Item = DVec3>) -> Surface {
        let weighted = points.map(|point| (point, 0.3));
        Surface::through(weighted, DVec3::ZERO, DVec3::X).expect("a surface")
    }

    #[test]
    fn an_inclined_plane_has_its_normal_everywhere() {
        let normal = DVec3::new(1.0, -0.3, 0.2).normalize();
        let depth = |y: f64, z: f64| 0.3 * y - 0.2 * z + 0.001;
        let surface = fitted(grid().map(|[y, z]| DVec3::new(depth(y, z), y, z)));
        for [y, z] in grid() {
            let error = surface.normal(DVec3::new(depth(y, z), y, z)) - normal;
            // The prior makes a slope smaller by its variance relative to that of the data, below 1e-4.
            assert!(error.length() < 1e-4, "{error}");
        }
    }

    #[test]
    fn a_cylinder_has_the_normal_from_its_axis() {
        const RADIUS: f64 = 0.012;
        let point = |y: f64, z: f64| {
            let depth = RADIUS - (RADIUS * RADIUS - y * y).sqrt();
            DVec3::new(depth, y, z)
        };
        let surface = fitted(grid().map(|[y, z]| point(y, z)));
        for [y, z] in grid() {
            let expected = DVec3::new((RADIUS * RADIUS - y * y).sqrt(), -y, 0.0) / RADIUS;
            let error = surface.normal(point(y, z)) - expected;
            // Terms of fourth order are missing: their slope is y³ / 2R³, 0.02 at the edge.
            assert!(error.length() < 0.02, "{y} {z}: {error}");
        }
    }

    #[test]
    fn one_tip_shows_a_flat_surface_and_none_shows_nothing() {
        let surface = fitted([DVec3::new(0.001, 0.002, 0.0)].into_iter());
        let normal = surface.normal(DVec3::new(0.001, 0.002, 0.0));
        assert!(normal.distance(DVec3::X) < 0.5, "{normal}");
        assert!(Surface::through(std::iter::empty(), DVec3::ZERO, DVec3::X).is_none());
    }
}
