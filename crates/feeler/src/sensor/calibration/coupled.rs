//! Coupled calibration of one element: each force as a function of growth and displacement.
//!
//! A column on preloaded cones tilts less the more it is pressed: `u_x` is proportional to
//! `F_x (h / (8 f_0 + F_z) + 1 / k)` and `G` to `8 f_0 + F_z`, so `F_x` is close to `a u_x + b g u_x` with the growth
//! `g = G / G_0 - 1`. Further terms model off-axis effects of the camera: the scale of the dewarping, spots cut by
//! the rim of the sub-region, and vignetting.
//!
//! Each force is a polynomial in inputs that are divided by their largest magnitude among the loads. It has no
//! constant term, so an unloaded element reads zero. The terms are ordered such that certain prefixes are complete
//! models ([`NORMAL_ORDERS`], [`SHEAR_ORDERS`]); cross-validation chooses the length.

pub(super) mod orders;

use super::least_squares::{MIN_SLOPE_RANGE, beyond, least_squares};
use super::relative_moments::RelativeMoments;
use glam::DVec3;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Numbers of terms of `F_z` that form complete models: growth only; with squares of the displacement, needed because
/// the element tilts; with all terms of second order; with terms of third and fourth order.
pub const NORMAL_ORDERS: [usize; 4] = [2, 7, 12, 20];

/// Numbers of terms of `F_x` and `F_y` that form complete models: linear in the displacement along the force; with the
/// cube of that displacement and more terms of the growth; with the displacement across the force; with squares of
/// displacements.
pub const SHEAR_ORDERS: [usize; 4] = [2, 5, 10, 17];

const NORMAL_TERMS: usize = NORMAL_ORDERS[3];
const SHEAR_TERMS: usize = SHEAR_ORDERS[3];

/// Polynomial terms of `F_z` in growth `g` and displacements `x`, `y`.
#[rustfmt::skip]
fn normal_terms([g, x, y]: [f64; 3]) -> [f64; NORMAL_TERMS] {
    let (gg, xx, yy, xy) = (g * g, x * x, y * y, x * y);
    [
        g, gg,
        xx, yy, xy, g * xx, g * yy,
        gg * g, x, y, g * x, g * y,
        g * xy, gg * x, gg * y, gg * gg, xx * x, xx * y, x * yy, yy * y,
    ]
}

/// Polynomial terms of a shear force in growth `g`, displacement `u` along the force and displacement `v` across it.
#[rustfmt::skip]
fn shear_terms([g, u, v]: [f64; 3]) -> [f64; SHEAR_TERMS] {
    let (gg, uu, vv, uv) = (g * g, u * u, v * v, u * v);
    [
        u, g * u,
        gg * u, uu * u, g,
        v, g * v, gg, u * vv, gg * g * u,
        gg * v, uu, uv, vv, g * uu, g * uv, g * vv,
    ]
}

fn polynomial(coefficients: &[f64], terms: &[f64]) -> f64 {
    coefficients.iter().zip(terms).map(|(c, t)| c * t).sum()
}

/// Forces on one element as functions of all its moments.
///
/// Inputs outside the range of the calibration's loads are clamped to it. The force that depends most on an input
/// (growth: `F_z`, x: `F_x`, y: `F_y`) is then extrapolated with its mean slope over that range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoupledMap {
    /// Minimum and maximum gray-value growth among the loads, including 0.
    pub growth_range: [f64; 2],
    /// Minimum and maximum displacement along x among the loads, including 0.
    pub x_range: [f64; 2],
    /// Minimum and maximum displacement along y among the loads, including 0.
    pub y_range: [f64; 2],
    /// Coefficients of `F_z`, N.
    pub normal: Vec<f64>,
    /// Coefficients of `F_x`, N.
    pub shear_x: Vec<f64>,
    /// Coefficients of `F_y`, N.
    pub shear_y: Vec<f64>,
}

/// Numbers of terms of `F_x`, `F_y` and `F_z`.
pub(in crate::sensor) type Orders = [usize; 3];

impl CoupledMap {
    /// Force in the element's frame `E_i`, N. Finite unless an input is NaN.
    pub fn force(&self, inputs: RelativeMoments) -> DVec3 {
        let ranges = self.ranges();
        let raw = inputs.components();
        let mut inside = [0.0; 3];
        let mut outside = [0.0; 3];
        for axis in 0..3 {
            let [low, high] = ranges[axis];
            inside[axis] = raw[axis].max(low).min(high) / scale(ranges[axis]);
            outside[axis] = beyond(raw[axis], ranges[axis]);
        }
        let [g, x, y] = inside;
        let mut force = DVec3::new(
            self.x_at([g, x, y]),
            self.y_at([g, x, y]),
            self.z_at([g, x, y]),
        );
        // Rare: outside the calibrated range.
        if outside != [0.0; 3] {
            let [growth, along_x, along_y] = outside;
            force.z += growth * mean_slope(self.growth_range, |g| self.z_at([g, x, y]));
            force.x += along_x * mean_slope(self.x_range, |x| self.x_at([g, x, y]));
            force.y += along_y * mean_slope(self.y_range, |y| self.y_at([g, x, y]));
        }
        force
    }

    /// Minimum and maximum of each input among the loads: gray-value growth, displacement along x, displacement along
    /// y.
    pub fn ranges(&self) -> [[f64; 2]; 3] {
        [self.growth_range, self.x_range, self.y_range]
    }

    fn x_at(&self, [g, x, y]: [f64; 3]) -> f64 {
        polynomial(&self.shear_x, &shear_terms([g, x, y]))
    }

    fn y_at(&self, [g, x, y]: [f64; 3]) -> f64 {
        polynomial(&self.shear_y, &shear_terms([g, y, x]))
    }

    fn z_at(&self, inputs: [f64; 3]) -> f64 {
        polynomial(&self.normal, &normal_terms(inputs))
    }

    /// Number of polynomial terms of each force component.
    pub(in crate::sensor) fn orders(&self) -> Orders {
        [&self.shear_x, &self.shear_y, &self.normal].map(Vec::len)
    }

    /// Least-squares fit of a polynomial for each force component to the loads. `orders` are their numbers of terms.
    pub(in crate::sensor) fn fit(
        inputs: &[RelativeMoments],
        forces: &[DVec3],
        orders: Orders,
    ) -> Result<Self, String> {
        let range = |input: fn(&RelativeMoments) -> f64, name: &str| {
            let low = inputs.iter().map(input).fold(0.0, f64::min);
            let high = inputs.iter().map(input).fold(0.0, f64::max);
            if high - low < MIN_SLOPE_RANGE {
                return Err(format!(
                    "expected loads that change the image, got {name} from {low} to {high}"
                ));
            }
            Ok([low, high])
        };
        let mut map = Self {
            growth_range: range(|i| i.growth, "growth")?,
            x_range: range(|i| i.displacement.x, "displacement x")?,
            y_range: range(|i| i.displacement.y, "displacement y")?,
            normal: Vec::new(),
            shear_x: Vec::new(),
            shear_y: Vec::new(),
        };
        let Loads {
            scaled,
            swapped,
            x,
            y,
            z,
        } = Loads::new(inputs, forces, map.ranges().map(scale));
        let [x_order, y_order, z_order] = orders;
        map.shear_x = solve(&scaled, shear_terms, x_order, &x)?;
        map.shear_y = solve(&swapped, shear_terms, y_order, &y)?;
        map.normal = solve(&scaled, normal_terms, z_order, &z)?;
        Ok(map)
    }

    /// Checks that the map gives finite forces; returns a description of the first invalid value.
    pub(in crate::sensor) fn check(&self) -> Result<(), String> {
        let names = ["growth_range", "x_range", "y_range"];
        for (name, [low, high]) in names.into_iter().zip(self.ranges()) {
            if !(low.is_finite() && high.is_finite() && low < high && low <= 0.0 && high >= 0.0) {
                return Err(format!(
                    "{name} must be increasing and contain 0, got {low} to {high}"
                ));
            }
        }
        let lists = [
            ("normal", &self.normal, NORMAL_ORDERS),
            ("shear_x", &self.shear_x, SHEAR_ORDERS),
            ("shear_y", &self.shear_y, SHEAR_ORDERS),
        ];
        for (name, list, orders) in lists {
            if !orders.contains(&list.len()) {
                let actual = list.len();
                return Err(format!(
                    "expected {name} to have one of {orders:?} terms, got {actual}"
                ));
            }
            // Terms are at most 1, so their sum stays finite, with room for the extrapolation.
            if let Some(wrong) = list.iter().find(|c| c.is_nan() || c.abs() > 1e100) {
                return Err(format!(
                    "expected {name} to have finite coefficients up to 1e100 N, got {wrong}"
                ));
            }
        }
        Ok(())
    }
}

/// Scaled inputs and measured forces for fitting the polynomials.
struct Loads {
    /// Growth and displacements along x and y, scaled to at most 1.
    scaled: Vec<[f64; 3]>,
    /// Like `scaled`, but with the displacement along y before that along x.
    swapped: Vec<[f64; 3]>,
    /// Measured `F_x` of each load, N.
    x: Vec<f64>,
    /// Measured `F_y` of each load, N.
    y: Vec<f64>,
    /// Measured `F_z` of each load, N.
    z: Vec<f64>,
}

impl Loads {
    /// Builds the inputs for the fit: each input is divided by its scale.
    fn new(inputs: &[RelativeMoments], forces: &[DVec3], [g, x, y]: [f64; 3]) -> Self {
        let scaled: Vec<[f64; 3]> = (inputs.iter())
            .map(|i| [i.growth / g, i.displacement.x / x, i.displacement.y / y])
            .collect();
        Self {
            swapped: scaled.iter().map(|&[g, x, y]| [g, y, x]).collect(),
            scaled,
            x: forces.iter().map(|force| force.x).collect(),
            y: forces.iter().map(|force| force.y).collect(),
            z: forces.iter().map(|force| force.z).collect(),
        }
    }
}

/// Largest absolute value in a range that contains 0.
fn scale([low, high]: [f64; 2]) -> f64 {
    high.max(-low)
}

/// Mean slope of a force over `range`, given the force as a function of the input divided by its scale.
fn mean_slope(range: [f64; 2], force: impl Fn(f64) -> f64) -> f64 {
    let [low, high] = range;
    let scale = scale(range);
    (force(high / scale) - force(low / scale)) / (high - low)
}

/// Least-squares fit of the first `order` coefficients of `terms` to `forces`.
fn solve<const N: usize>(
    inputs: &[[f64; 3]],
    terms: fn([f64; 3]) -> [f64; N],
    order: usize,
    forces: &[f64],
) -> Result<Vec<f64>, String> {
    let mut columns = DMatrix::zeros(inputs.len(), order);
    for (row, &inputs) in inputs.iter().enumerate() {
        for (column, term) in terms(inputs).into_iter().take(order).enumerate() {
            columns[(row, column)] = term;
        }
    }
    least_squares(columns, forces)
}
