//! The coupled calibration beyond the range of its loads.

use feeler::sensor::calibration::{CoupledMap, RelativeMoments};
use glam::{DVec2, DVec3};

/// Asymmetrical ranges of different widths, so that none can be mistaken for another.
const GROWTH: [f64; 2] = [-0.1, 2.0];
const X: [f64; 2] = [-2e-4, 3e-4];
const Y: [f64; 2] = [-8e-4, 5e-4];

/// Forces with a curved part: a parabola of growth, and cubes of the displacements.
fn map() -> CoupledMap {
    CoupledMap {
        growth_range: GROWTH,
        x_range: X,
        y_range: Y,
        normal: vec![1.5, 0.4],
        shear_x: vec![0.7, 0.0, 0.0, -0.2, 0.0],
        shear_y: vec![0.9, 0.0, 0.0, -0.3, 0.0],
    }
}

/// Normal force as a function of growth, in SI units, like [`map`].
fn normal(growth: f64) -> f64 {
    let g = growth / 2.0;
    1.5 * g + 0.4 * g * g
}

fn shear_x(x: f64) -> f64 {
    let x = x / 3e-4;
    0.7 * x - 0.2 * x.powi(3)
}

fn shear_y(y: f64) -> f64 {
    let y = y / 8e-4;
    0.9 * y - 0.3 * y.powi(3)
}

/// Value of `force` at `input` if it continues from the ends of `[low, high]` with its mean slope over that range.
fn continued(force: fn(f64) -> f64, input: f64, [low, high]: [f64; 2]) -> f64 {
    let end = input.clamp(low, high);
    force(end) + (input - end) * (force(high) - force(low)) / (high - low)
}

#[test]
fn each_force_continues_with_its_mean_slope_over_its_inputs_range() {
    let map = map();
    let reach = |[low, high]: [f64; 2]| {
        let width = high - low;
        [low - 0.5 * width, low, 0.0, high, high + 0.5 * width]
    };
    for growth in reach(GROWTH) {
        for x in reach(X) {
            for y in reach(Y) {
                let displacement = DVec2::new(x, y);
                let force = map.force(RelativeMoments {
                    growth,
                    displacement,
                });
                let expected = DVec3::new(
                    continued(shear_x, x, X),
                    continued(shear_y, y, Y),
                    continued(normal, growth, GROWTH),
                );
                // Rounding of the same few products in another order.
                let error = (force - expected).abs().max_element();
                assert!(
                    error < 1e-12,
                    "{force} N instead of {expected} N at {growth}, {displacement} m"
                );
            }
        }
    }
}
