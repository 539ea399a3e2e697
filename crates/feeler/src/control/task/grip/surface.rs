//! Surface of an object at a contact, from the positions of the loaded tips.

use crate::control::feeler_shape::FeelerShape;
use crate::control::sense::FingerReadings;
use glam::DVec3;
use nalgebra::{SMatrix, SVector};

/// Unit of the coordinates in the fit (m), so that all terms are of similar size.
const UNIT: f64 = 1e-3;
/// Standard deviation of the position of a tip (m), and those of the slope and of the curvature (1/m) of an object. With few
/// tips, the surface is as flat as they allow.
const TIP_ERROR: f64 = 1e-5;
const SLOPE: f64 = 1.0;
const CURVATURE: f64 = 300.0;

/// Surface of an object: depth along the closing direction, as a polynomial of second order in the coordinates across it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    approach: DVec3,
    across: [DVec3; 2],
    origin: DVec3,
    /// Of 1, x, y, x²/2, xy and y²/2, in units of [`UNIT`].
    coefficients: SVector<f64, 6>,
}

impl Surface {
    /// Fits the surface to the tips of `finger` that press along `approach` with more than `least` (N), weighted by their
    /// force. `feeler` is the shape of the feelers in series with the object. `None` if no tip presses.
    pub fn fit(
        finger: &FingerReadings<'_>,
        approach: DVec3,
        feeler: &FeelerShape,
        least: f64,
    ) -> Option<Self> {
        let (x, y) = approach.any_orthonormal_pair();
        let mut surface = Self {
            approach,
            across: [x, y],
            origin: finger.pose.position + finger.layout.dome_radius * approach,
            coefficients: SVector::zeros(),
        };
        let mut matrix = SMatrix::<f64, 6, 6>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        let mut total = 0.0;
        for element in 0..finger.touch.frame.forces.len() {
            let force = finger.force(element);
            let pressing = -force.dot(approach);
            if pressing <= least {
                continue;
            }
            let tip = feeler.tip(finger, element, force)?;
            let [x, y] = surface.coordinates(tip);
            let depth = (tip - surface.origin).dot(approach) / UNIT;
            let row = SVector::from([1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y]);
            matrix += pressing * row * row.transpose();
            right += pressing * depth * row;
            total += pressing;
        }
        let error = TIP_ERROR / UNIT;
        let slope = (error / SLOPE) * (error / SLOPE);
        let curvature = (error / (CURVATURE * UNIT)) * (error / (CURVATURE * UNIT));
        for (index, prior) in [0.0, slope, slope, curvature, curvature, curvature]
            .into_iter()
            .enumerate()
        {
            matrix[(index, index)] += prior * total;
        }
        surface.coefficients = matrix.cholesky()?.solve(&right);
        Some(surface)
    }

    /// Coordinates of `position` (m, in W) across the closing direction, in units of [`UNIT`].
    fn coordinates(&self, position: DVec3) -> [f64; 2] {
        self.across
            .map(|axis| (position - self.origin).dot(axis) / UNIT)
    }

    /// Normal at `position` (m, in W), a unit vector in W into the object.
    pub fn normal(&self, position: DVec3) -> DVec3 {
        let [x, y] = self.coordinates(position);
        let c = &self.coefficients;
        let [along_x, along_y] = [c[1] + c[3] * x + c[4] * y, c[2] + c[4] * x + c[5] * y];
        let [across_x, across_y] = self.across;
        (self.approach - along_x * across_x - along_y * across_y).normalize()
    }
}
