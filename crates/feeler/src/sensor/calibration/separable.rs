//! The paper's separable calibration (section II) of one element: `F_z = g(G)`, `F_x = f_x(u_x)`, `F_y = f_y(u_y)`.
//!
//! It does not model the influence of the normal force on the displacement caused by a shear force.

use super::least_squares::{MIN_SLOPE_RANGE, beyond, least_squares};
use super::relative_moments::RelativeMoments;
use glam::DVec3;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Number of terms of a [`ForceCurve`].
const CURVE_TERMS: usize = 3;

/// A force as a polynomial of one input, zero at zero.
///
/// Within the range of the fitted inputs, `F(s) = c_1 s + c_2 s^2 + c_3 s^3`. Outside, where the polynomial is
/// unreliable, the curve is extrapolated linearly with its mean slope over the range, so that the force keeps growing
/// with the input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceCurve {
    /// Minimum and maximum input among the calibration's loads, including 0.
    pub range: [f64; 2],
    /// `c_1, c_2, c_3`, N per power of the input.
    pub coefficients: [f64; CURVE_TERMS],
}

impl ForceCurve {
    /// Force at `input`, N. Finite unless `input` is NaN.
    pub fn force(&self, input: f64) -> f64 {
        let [low, high] = self.range;
        let inside = input.max(low).min(high);
        self.polynomial(inside) + beyond(input, self.range) * self.mean_slope()
    }

    fn polynomial(&self, s: f64) -> f64 {
        self.coefficients
            .iter()
            .rev()
            .fold(0.0, |sum, c| (sum + c) * s)
    }

    fn mean_slope(&self) -> f64 {
        let [low, high] = self.range;
        (self.polynomial(high) - self.polynomial(low)) / (high - low)
    }

    /// Least-squares fit of a polynomial without a constant term to `forces` at `inputs`.
    fn fit(inputs: &[f64], forces: &[f64]) -> Result<Self, String> {
        // The unloaded state is a known load too: the range includes 0, where the curve is exactly 0.
        let low = inputs.iter().copied().fold(0.0, f64::min);
        let high = inputs.iter().copied().fold(0.0, f64::max);
        if high - low < MIN_SLOPE_RANGE {
            return Err(format!(
                "expected loads that change the image, got inputs from {low} to {high}"
            ));
        }
        // RelativeMoments are scaled to at most 1, so that the columns have similar magnitudes.
        let scale = low.abs().max(high.abs());
        let columns = DMatrix::from_fn(inputs.len(), CURVE_TERMS, |row, term| {
            (inputs[row] / scale).powi(term as i32 + 1)
        });
        let solution = least_squares(columns, forces)?;
        Ok(Self {
            range: [low, high],
            coefficients: std::array::from_fn(|term| solution[term] / scale.powi(term as i32 + 1)),
        })
    }

    /// Checks that the curve gives finite forces; returns a description of the first invalid value.
    fn check(&self, name: &str) -> Result<(), String> {
        let [low, high] = self.range;
        if !(low.is_finite() && high.is_finite() && low < high && low <= 0.0 && high >= 0.0) {
            return Err(format!(
                "{name}.range must be increasing and contain 0, got {low} to {high}"
            ));
        }
        if !(self.force(low).is_finite() && self.mean_slope().is_finite()) {
            let coefficients = self.coefficients;
            return Err(format!(
                "{name}.coefficients must give finite forces, got {coefficients:?}"
            ));
        }
        Ok(())
    }
}

/// One curve for each component of an element's force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeparableMap {
    /// Compression `F_z` as a function of the relative growth of the integrated gray value, `G / G_0 - 1`.
    pub normal: ForceCurve,
    /// Shear `F_x` as a function of the centroid's displacement along x.
    pub shear_x: ForceCurve,
    /// Shear `F_y` as a function of the centroid's displacement along y.
    pub shear_y: ForceCurve,
}

impl SeparableMap {
    /// Force in the element's frame `E_i`, N.
    pub fn force(&self, inputs: RelativeMoments) -> DVec3 {
        DVec3::new(
            self.shear_x.force(inputs.displacement.x),
            self.shear_y.force(inputs.displacement.y),
            self.normal.force(inputs.growth),
        )
    }

    /// Minimum and maximum of each input among the loads: gray-value growth, displacement along x, displacement along
    /// y.
    pub fn ranges(&self) -> [[f64; 2]; 3] {
        [self.normal.range, self.shear_x.range, self.shear_y.range]
    }

    /// Fits one curve to each component of the forces.
    pub(in crate::sensor) fn fit(
        inputs: &[RelativeMoments],
        forces: &[DVec3],
    ) -> Result<Self, String> {
        let curve = |input: fn(&RelativeMoments) -> f64, force: fn(&DVec3) -> f64| {
            let inputs: Vec<_> = inputs.iter().map(input).collect();
            let forces: Vec<_> = forces.iter().map(force).collect();
            ForceCurve::fit(&inputs, &forces)
        };
        Ok(Self {
            normal: curve(|i| i.growth, |f| f.z)?,
            shear_x: curve(|i| i.displacement.x, |f| f.x)?,
            shear_y: curve(|i| i.displacement.y, |f| f.y)?,
        })
    }

    pub(in crate::sensor) fn check(&self) -> Result<(), String> {
        self.normal.check("normal")?;
        self.shear_x.check("shear_x")?;
        self.shear_y.check("shear_y")
    }
}
