//! Least-squares circle through the contact points of all fingers, projected along the object's axis.

use glam::DVec2;
use nalgebra::{Matrix3, Vector3};

/// Weight of the prior relative to one contact point.
const PRIOR_WEIGHT: f64 = 0.3;

/// A circle in the x-y plane of W.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Circle {
    /// Centre (m, x and y in W).
    pub centre: DVec2,
    /// Radius (m).
    pub radius: f64,
}

/// Running sums of an algebraic circle fit (Kåsa, IEEE Trans. Instrum. Meas. 25, 1976) with a weak prior.
///
/// The circle `x² + y² = a x + b y + g` minimises the sum of squared residuals. Coordinates are relative to the
/// prior's centre for numerical accuracy.
#[derive(Debug, Clone)]
pub(super) struct CircleFit {
    prior: Circle,
    /// Matrix of the normal equations for (a, b, g).
    matrix: Matrix3<f64>,
    right: Vector3<f64>,
}

impl CircleFit {
    /// Creates a fit without points. The prior is a circle around `centre` (m, in W) with `radius` (m).
    pub fn new(centre: DVec2, radius: f64) -> Self {
        let square = radius * radius;
        Self {
            prior: Circle { centre, radius },
            // a = b = 0 and g = radius², scaled like a contact point at that radius.
            matrix: PRIOR_WEIGHT * Matrix3::from_diagonal(&Vector3::new(square, square, 1.0)),
            right: PRIOR_WEIGHT * Vector3::new(0.0, 0.0, square),
        }
    }

    /// Adds a contact point (m, x and y in W) to the sums.
    pub fn add(&mut self, point: DVec2) {
        let point = point - self.prior.centre;
        let row = Vector3::new(point.x, point.y, 1.0);
        self.matrix += row * row.transpose();
        self.right += row * point.length_squared();
    }

    /// Circle that best fits all points and the prior.
    pub fn circle(&self) -> Circle {
        // The prior makes the matrix positive definite.
        let Some(factor) = self.matrix.cholesky() else {
            return self.prior;
        };
        let solution = factor.solve(&self.right);
        let offset = 0.5 * DVec2::new(solution[0], solution[1]);
        Circle {
            centre: self.prior.centre + offset,
            radius: (solution[2] + offset.length_squared()).max(0.0).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fits points at `angles` (rad) on a circle of 16 mm around (3, -2) mm.
    fn fitted(angles: impl IntoIterator<Item = f64>) -> Circle {
        let mut fit = CircleFit::new(DVec2::ZERO, 0.012);
        for angle in angles {
            fit.add(DVec2::new(0.003, -0.002) + 0.016 * DVec2::from_angle(angle));
        }
        fit.circle()
    }

    #[test]
    fn the_prior_alone_is_the_circle() {
        let circle = fitted([]);
        assert!(circle.centre.length() < 1e-12 && (circle.radius - 0.012).abs() < 1e-12);
    }

    /// The contacts of two fingers sweep 0.3 rad on opposite sides, with as many points as in two strokes. Across the
    /// line between the fingers, the prior has 0.3 % of the points' weight and is off by 2 mm, which gives 6 µm.
    #[test]
    fn contacts_on_both_sides_give_centre_and_radius() {
        let sweep = (0..1000).map(|i| 3e-4 * f64::from(i));
        let circle = fitted(sweep.flat_map(|a| [a, a + std::f64::consts::PI]));
        let error = circle.centre.distance(DVec2::new(0.003, -0.002));
        assert!(
            error < 2e-5 && (circle.radius - 0.016).abs() < 2e-5,
            "{circle:?} {error}"
        );
    }
}
