//! A soft gel with markers: displacement of the markers under forces on its surface.
//!
//! The gel is an incompressible elastic layer (Poisson's ratio 1/2, as silicone nearly is) that is bonded to a rigid
//! base. Its response to a surface load of wave number q is (x = q h, with thickness h and shear modulus G):
//!
//! ```text
//! D = cosh 2x + 2 x² + 1
//! pressure p:  inward    (sinh 2x - 2x) / (2 G q D) p
//!              outward   2 x² / (2 G q² D) times the gradient of -p, along the surface
//! shear t:     along q   (sinh 2x + 2x) / (2 G q D) t
//!              across q  tanh x / (G q) t
//! ```
//!
//! For a force with a normal distribution of standard deviation s, the responses are multiplied by exp(-q² s² / 2) and
//! integrated over q (Hankel transforms).

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Upper limit of wave numbers in units of 1 / s, where the spectrum of a load has fallen to e^-18.
const LAST: f64 = 6.0;
/// Number of rows of the table per standard deviation of the load.
const PARTS: f64 = 3.0;
/// Upper limit of `x`. Hyperbolic functions equal exponentials beyond it, and overflow for larger values.
const DEEP: f64 = 300.0;

/// Displacement of the surface at some distance from a force of 1 N (m).
#[derive(Debug, Clone, Copy, Default)]
struct Compliance {
    /// Tangential displacement parallel to a tangential force, at a point in the direction of the force.
    along: f64,
    /// Tangential displacement parallel to a tangential force, at a point perpendicular to the direction of the force.
    across: f64,
    /// Tangential displacement away from a normal force.
    outward: f64,
    /// Normal displacement into the gel due to a normal force.
    sunk: f64,
}

/// A gel layer and its response to distributed forces.
#[derive(Debug, Clone)]
pub struct GelLayer {
    thickness: f64,
    shear_modulus: f64,
    /// Distance between two rows of the table (m).
    step: f64,
    /// Responses at the distances 0, `step`, 2 `step`, ...
    table: Vec<Compliance>,
}

impl GelLayer {
    /// Creates a gel of `thickness` (m) and `shear_modulus` (Pa) under forces with a normal distribution of standard
    /// deviation `spread` (m). The response is tabulated up to the distance `reach` (m), and 0 beyond. All must be
    /// positive.
    pub fn new(thickness: f64, shear_modulus: f64, spread: f64, reach: f64) -> Self {
        let step = spread / PARTS;
        let rows = (reach / step).ceil() as usize + 1;
        let mut layer = Self {
            thickness,
            shear_modulus,
            step,
            table: Vec::new(),
        };
        let distance = |row: usize| row as f64 * step;
        layer.table = (0..rows)
            .map(|row| layer.response(distance(row), spread, reach))
            .collect();
        layer
    }

    /// Normal and shear stiffness per area (N/m³) for loads of `wave_number` (rad/m), about the inverse of a contact's
    /// radius.
    pub fn stiffness(&self, wave_number: f64) -> [f64; 2] {
        let [along, across, _, sunk] = self.response_of(wave_number);
        [1.0 / sunk, 2.0 / (along + across)]
    }

    /// Displacement of the surface at `at` (m) due to a `force` on the gel (N) at `from` (m): x and y along the
    /// surface, z inward, for force and displacement.
    pub fn displacement(&self, from: DVec2, at: DVec2, force: DVec3) -> DVec3 {
        let apart = at - from;
        let row = apart.length() / self.step;
        let index = row as usize;
        let Some([before, after]) = self.table.get(index..).and_then(|rest| rest.first_chunk())
        else {
            return DVec3::ZERO;
        };
        let between = |of: fn(&Compliance) -> f64| {
            let (before, after) = (of(before), of(after));
            before + (row - index as f64) * (after - before)
        };
        let (along, across) = (between(|c| c.along), between(|c| c.across));
        let outward = between(|c| c.outward);
        let direction = apart.normalize_or_zero();
        let shear = force.truncate();
        let ahead = direction.dot(shear);
        let moved = across * shear + ((along - across) * ahead + outward * force.z) * direction;
        // A shear force raises the gel ahead of it, by reciprocity with the outward displacement of a normal force.
        moved.extend(between(|c| c.sunk) * force.z - outward * ahead)
    }

    /// Amplitudes of the displacement (m) under a load wave of amplitude 1 Pa and `wave_number` (rad/m): tangential
    /// along and across the wave for a shear load, then outward along the surface and inward for a pressure.
    fn response_of(&self, wave_number: f64) -> [f64; 4] {
        let x = (wave_number * self.thickness).min(DEEP);
        let doubled = 2.0 * x;
        let below = libm::cosh(doubled) + 2.0 * x * x + 1.0;
        let half_space = 1.0 / (2.0 * self.shear_modulus * wave_number);
        [
            half_space * (libm::sinh(doubled) + doubled) / below,
            half_space * 2.0 * libm::tanh(x),
            half_space * 2.0 * x * x / below,
            half_space * (libm::sinh(doubled) - doubled) / below,
        ]
    }

    /// Displacement of the surface at `distance` (m) from the centre of a force of 1 N, which has a normal distribution
    /// of standard deviation `spread` (m). `reach` is the largest distance of the table (m).
    fn response(&self, distance: f64, spread: f64, reach: f64) -> Compliance {
        let last = LAST / spread;
        // Several points per period of the Bessel functions, which oscillate fastest at the largest distance.
        let points = (4.0 * last * reach.max(self.thickness)).ceil();
        let width = last / points;
        let mut sum = Compliance::default();
        for point in 1..=points as usize {
            let wave_number = point as f64 * width;
            let [along, across, outward, sunk] = self.response_of(wave_number);
            let turn = wave_number * distance;
            let (j0, j1) = (bessel(0, turn), bessel(1, turn));
            let beside = match turn > 0.0 {
                true => j1 / turn,
                false => 0.5,
            };
            let strength = libm::exp(-(wave_number * spread).powi(2) / 2.0);
            let weight = strength * wave_number * width / TAU;
            sum.along += weight * (along * (j0 - beside) + across * beside);
            sum.across += weight * (along * beside + across * (j0 - beside));
            sum.outward += weight * outward * j1;
            sum.sunk += weight * sunk * j0;
        }
        sum
    }
}

/// Bessel function of the first kind of `order` 0 or 1, by the trapezoidal rule for its integral; exact up to rounding
/// with more points than half of `at`.
fn bessel(order: i32, at: f64) -> f64 {
    let points = (0.5 * at).ceil() as usize + 16;
    let value = |point: usize| {
        let angle = PI * point as f64 / points as f64;
        libm::cos(f64::from(order) * angle - at * libm::sin(angle))
    };
    let ends = 0.5 * (value(0) + value(points));
    ((1..points).map(value).sum::<f64>() + ends) / points as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz and Stegun, table 9.1: J0 and J1 at 1 and 5.
    #[test]
    fn bessel_functions_match_tables() {
        let known = [
            (0, 1.0, 0.765_197_686_6),
            (1, 1.0, 0.440_050_585_7),
            (0, 5.0, -0.177_596_771_3),
            (1, 5.0, -0.327_579_137_6),
        ];
        for (order, at, value) in known {
            assert!((bessel(order, at) - value).abs() < 1e-10, "J{order}({at})");
        }
    }

    /// Near a force on a thick gel: Boussinesq's and Cerruti's solutions for an incompressible half-space,
    /// w = P / 4 pi G r and u = T / 2 pi G r ahead of the force, half of that beside it. The relative error is about r
    /// / h; here h = 60 r.
    #[test]
    fn a_thick_gel_matches_a_half_space() {
        let (modulus, apart) = (5e4, 2e-3);
        let gel = GelLayer::new(0.12, modulus, 2e-4, 2.2e-3);
        let unit = 1.0 / (4.0 * PI * modulus * apart);
        let near = |value: f64, expected: f64| {
            assert!(
                (value - expected).abs() < 0.03 * unit,
                "{value}, expected {expected}"
            );
        };
        let at = apart * DVec2::X;
        let pressed = gel.displacement(DVec2::ZERO, at, DVec3::Z);
        near(pressed.z, unit);
        near(pressed.x, 0.0);
        near(gel.displacement(DVec2::ZERO, at, DVec3::X).x, 2.0 * unit);
        near(gel.displacement(DVec2::ZERO, at, DVec3::Y).y, unit);
    }

    /// A thin gel: shear stiffness G / h, and by lubrication theory h^2 / 2 G times the pressure gradient outward.
    #[test]
    fn a_thin_gel_matches_lubrication_theory() {
        let (thickness, modulus, spread) = (1e-4, 5e4, 2e-3);
        let gel = GelLayer::new(thickness, modulus, spread, 8e-3);
        let pressure = |r: f64| (-r * r / (2.0 * spread * spread)).exp() / (TAU * spread * spread);
        // At a row of the table, so without interpolation.
        let r = spread;
        let at = r * DVec2::Y;
        let sheared = gel.displacement(DVec2::ZERO, at, DVec3::X).x;
        let expected = pressure(r) * thickness / modulus;
        assert!(
            (sheared / expected - 1.0).abs() < 0.02,
            "{sheared}, expected {expected}"
        );
        let squeezed = gel.displacement(DVec2::ZERO, at, DVec3::Z).y;
        let gradient = pressure(r) * r / (spread * spread);
        let expected = thickness * thickness / (2.0 * modulus) * gradient;
        assert!(
            (squeezed / expected - 1.0).abs() < 0.02,
            "{squeezed}, expected {expected}"
        );
    }

    /// Maxwell-Betti reciprocity of responses at two places.
    #[test]
    fn responses_are_reciprocal() {
        let gel = GelLayer::new(4e-3, 5e4, 1e-3, 2e-2);
        let (here, there) = (DVec2::new(1e-3, 2e-3), DVec2::new(-3e-3, 3.5e-3));
        for one in DVec3::AXES {
            for other in DVec3::AXES {
                let there_of_here = gel.displacement(here, there, one).dot(other);
                let here_of_there = gel.displacement(there, here, other).dot(one);
                assert!((there_of_here - here_of_there).abs() < 1e-12);
            }
        }
    }
}
