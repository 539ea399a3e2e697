//! The separable calibration of the paper (section II), for one element: `F_z = g(G)`,
//! `F_x = f_x(u_x)`, `F_y = f_y(u_y)`.
//!
//! It knows nothing of how a normal force changes the displacement that a shear force causes.

use super::{
    calibration::Inputs,
    least_squares::{LEAST_SLOPE_RANGE, beyond, least_squares},
};
use glam::DVec3;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Terms of a [`ForceCurve`].
pub const CURVE_TERMS: usize = 3;

/// A force as a polynomial of one input, zero at zero.
///
/// Inside the range of inputs it was fitted on, `F(s) = c_1 s + c_2 s^2 + c_3 s^3`. Outside, the
/// polynomial may do anything, so the curve goes on from the range's end as a straight line with the
/// mean slope of the whole curve: where the picture keeps growing stronger, so does the force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceCurve {
    /// Least and greatest input among the loads, no load included: 0 lies within.
    pub range: [f64; 2],
    /// `c_1, c_2, c_3`, N per power of the input.
    pub coefficients: [f64; CURVE_TERMS],
}

impl ForceCurve {
    /// Force at `input`, N. Finite for every input that is a number.
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

    /// The polynomial without a constant term that is nearest to `forces` at `inputs`.
    fn fit(inputs: &[f64], forces: &[f64]) -> Result<Self, String> {
        // No load is a known load too: the range reaches to 0, where the curve is exactly 0.
        let low = inputs.iter().copied().fold(0.0, f64::min);
        let high = inputs.iter().copied().fold(0.0, f64::max);
        if high - low < LEAST_SLOPE_RANGE {
            return Err(format!(
                "loads that change the picture expected, got inputs from {low} to {high}"
            ));
        }
        // Inputs are scaled to at most 1 so that the columns are of one size.
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

    /// Says what makes a force of the curve unusable.
    fn check(&self, name: &str) -> Result<(), String> {
        let [low, high] = self.range;
        if !(low.is_finite() && high.is_finite() && low < high && low <= 0.0 && high >= 0.0) {
            return Err(format!(
                "{name}.range must rise and hold 0, got {low} to {high}"
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
    /// Compression `F_z` over the relative growth of the integrated gray value, `G / G_0 - 1`.
    pub normal: ForceCurve,
    /// Shear `F_x` over the centroid's displacement along x.
    pub shear_x: ForceCurve,
    /// Shear `F_y` over the centroid's displacement along y.
    pub shear_y: ForceCurve,
}

impl SeparableMap {
    /// The force in `E_i`, N.
    pub fn force(&self, inputs: Inputs) -> DVec3 {
        DVec3::new(
            self.shear_x.force(inputs.displacement.x),
            self.shear_y.force(inputs.displacement.y),
            self.normal.force(inputs.growth),
        )
    }

    /// Least and greatest growth, x and y among the loads.
    pub fn ranges(&self) -> [[f64; 2]; 3] {
        [self.normal.range, self.shear_x.range, self.shear_y.range]
    }

    /// Fits one curve to each component of the forces.
    pub(super) fn fit(inputs: &[Inputs], forces: &[DVec3]) -> Result<Self, String> {
        let curve = |input: fn(&Inputs) -> f64, force: fn(&DVec3) -> f64| {
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

    pub(super) fn check(&self) -> Result<(), String> {
        self.normal.check("normal")?;
        self.shear_x.check("shear_x")?;
        self.shear_y.check("shear_y")
    }
}
