//! Coupled model: meaning and number of coefficients, and the choice between models.

use super::element::{RANGES, fitted, inputs, places, record};
use feeler::sensor::calibration::{
    CalibrationModel, CoupledMap, ForceMap, ModelChoice, NORMAL_ORDERS, RelativeMoments,
    SHEAR_ORDERS,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Exponents of growth, x and y in the terms of `F_z`, in the order of the coefficients in calibration files.
const NORMAL: [[i32; 3]; 20] = [
    [1, 0, 0],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [0, 1, 1],
    [1, 2, 0],
    [1, 0, 2],
    [3, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 0],
    [1, 0, 1],
    [1, 1, 1],
    [2, 1, 0],
    [2, 0, 1],
    [4, 0, 0],
    [0, 3, 0],
    [0, 2, 1],
    [0, 1, 2],
    [0, 0, 3],
];

/// Exponents of growth, of the displacement along a shear force, and of the displacement across it.
const SHEAR: [[i32; 3]; 17] = [
    [0, 1, 0],
    [1, 1, 0],
    [2, 1, 0],
    [0, 3, 0],
    [1, 0, 0],
    [0, 0, 1],
    [1, 0, 1],
    [2, 0, 0],
    [0, 1, 2],
    [3, 1, 0],
    [2, 0, 1],
    [0, 2, 0],
    [0, 1, 1],
    [0, 0, 2],
    [1, 2, 0],
    [1, 1, 1],
    [1, 0, 2],
];

/// Growth, x and y, each relative to the largest magnitude of its range in `RANGES`.
fn scaled(inputs: RelativeMoments) -> [f64; 3] {
    [
        inputs.growth / 0.8,
        inputs.displacement.x / 3.0,
        inputs.displacement.y / 4.0,
    ]
}

fn sum(terms: &[[i32; 3]], coefficients: &[f64], at: [f64; 3]) -> f64 {
    let term = |powers: &[i32; 3]| -> f64 { (0..3).map(|i| at[i].powi(powers[i])).product() };
    terms
        .iter()
        .zip(coefficients)
        .map(|(t, c)| c * term(t))
        .sum()
}

/// Force at `inputs` of a map with these coefficients of `F_x`, `F_y` and `F_z`.
fn force([x, y, z]: &[Vec<f64>; 3], inputs: RelativeMoments) -> DVec3 {
    let [g, u, v] = scaled(inputs);
    DVec3::new(
        sum(&SHEAR, x, [g, u, v]),
        sum(&SHEAR, y, [g, v, u]),
        sum(&NORMAL, z, [g, u, v]),
    )
}

/// Random coefficients of each component, with magnitudes from 0.5 to 1 and alternating signs.
fn coefficients(orders: [usize; 3], seed: u64) -> [Vec<f64>; 3] {
    let mut rng = Pcg64::seed_from_u64(seed);
    orders.map(|order| {
        let one = |n: usize| rng.random_range(0.5..1.0) * [1.0, -1.0][n % 2];
        (0..order).map(one).collect()
    })
}

/// Negates each component that decreases over the range of its input, because such calibrations are rejected.
fn rising(mut own: [Vec<f64>; 3]) -> [Vec<f64>; 3] {
    let [g, x, y] = RANGES;
    let half = 0.5 * g[1];
    let ends = [
        [[half, x[0], 0.0], [half, x[1], 0.0]],
        [[half, 0.0, y[0]], [half, 0.0, y[1]]],
        [[g[0], 0.0, 0.0], [g[1], 0.0, 0.0]],
    ];
    let rises = ends.map(|ends| ends.map(|at| force(&own, inputs(at))));
    for (axis, (component, [low, high])) in own.iter_mut().zip(rises).enumerate() {
        let sign = if high[axis] < low[axis] { -1.0 } else { 1.0 };
        component
            .iter_mut()
            .for_each(|coefficient| *coefficient *= sign);
    }
    own
}

fn map([shear_x, shear_y, normal]: [Vec<f64>; 3]) -> CoupledMap {
    let [growth_range, x_range, y_range] = RANGES;
    CoupledMap {
        growth_range,
        x_range,
        y_range,
        normal,
        shear_x,
        shear_y,
    }
}

fn coupled(map: &ForceMap) -> &CoupledMap {
    match map {
        ForceMap::Coupled(map) => map,
        ForceMap::Separable(_) => panic!("the coupled model"),
    }
}

#[test]
fn each_coefficient_multiplies_its_power_of_the_scaled_inputs() {
    for term in 0..20 {
        let unit = |count: usize| (0..count).map(|n| f64::from(n == term)).collect();
        let own = [unit(17), unit(17), unit(20)];
        let map = map(own.clone());
        for inputs in places(20, 4) {
            let error = map.force(inputs).distance(force(&own, inputs));
            assert!(
                error < 1e-14,
                "term {term} at {inputs:?}: error of {error} N"
            );
        }
    }
}

/// The fit selects as many terms as the force has: more do not improve the prediction.
#[test]
fn the_fit_recovers_the_number_of_terms_and_the_force() {
    for n in 0..4 {
        let orders = [SHEAR_ORDERS[n], SHEAR_ORDERS[3 - n], NORMAL_ORDERS[n]];
        let own = rising(coefficients(orders, n as u64));
        let mut rng = Pcg64::seed_from_u64(5);
        // Noise of at most a ten-thousandth of the force, so that an exact fit does not favour a longer model.
        let places = places(300, 6);
        let noise: Vec<DVec3> = places
            .iter()
            .map(|_| DVec3::from_array([(); 3].map(|()| rng.random_range(-1e-4..1e-4))))
            .collect();
        let mut noise = noise.into_iter();
        let noisy: Vec<(RelativeMoments, DVec3)> = places
            .iter()
            .map(|&i| (i, force(&own, i) + noise.next().expect("noise")))
            .collect();
        let of = |inputs: RelativeMoments| {
            let found = noisy.iter().find(|(i, _)| *i == inputs);
            found.expect("a place").1
        };
        let calibration =
            fitted(&[record(&places, of)], ModelChoice::Coupled).expect("a calibration");
        assert_eq!(calibration.model(), CalibrationModel::Coupled);
        let map = coupled(&calibration.elements[0].map);
        let lengths = [&map.shear_x, &map.shear_y, &map.normal].map(Vec::len);
        assert_eq!(lengths, orders);
        for (found, expected) in map.ranges().into_iter().zip(RANGES) {
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-9, "{:?}", map.ranges());
            }
        }
        for inputs in self::places(30, 7) {
            let error = map.force(inputs).distance(force(&own, inputs));
            // The noise is averaged over 300 loads; at a corner, twenty terms add up.
            assert!(error < 1e-4, "error of {error} N at {inputs:?}");
        }
        let held_out = calibration.elements[0].quality.held_out;
        // Standard deviation of the noise, 1e-4 / sqrt(3), and a tenth more for the error of the fit.
        assert!(held_out.rms.max_element() < 0.65e-4, "{held_out:?}");
        assert!(held_out.rms.min_element() > 0.5e-4, "{held_out:?}");
    }
}

#[test]
fn forces_far_beyond_the_loads_are_finite_and_nan_stays_nan() {
    let map = map(coefficients([17, 17, 20], 8));
    for far in [1e300, -1e300, f64::INFINITY, f64::NEG_INFINITY] {
        for at in [[far, 0.0, 0.0], [0.0, far, 0.0], [0.0, 0.0, far], [far; 3]] {
            assert!(map.force(inputs(at)).is_finite(), "at {at:?}");
        }
    }
    for at in [
        [f64::NAN, 0.0, 0.0],
        [0.0, f64::NAN, 0.0],
        [0.0, 0.0, f64::NAN],
    ] {
        assert!(map.force(inputs(at)).is_nan(), "at {at:?}");
    }
}

/// The model with the smaller held-out error, or the separable one if there are too few loads for the coupled one.
#[test]
fn the_model_that_predicts_better_is_chosen() {
    let separable = |i: RelativeMoments| {
        let [g, x, y] = scaled(i);
        // Terms that the coupled model lacks.
        DVec3::new(
            x + 0.5 * x.powi(2),
            y - 0.3 * y.powi(2) + 0.2 * y.powi(3),
            g + g.powi(3),
        )
    };
    let few = record(&places(15, 9), |i| separable(i) + 0.2 * i.growth * DVec3::X);
    let chosen = |record| {
        fitted(&[record], ModelChoice::Auto)
            .expect("a calibration")
            .model()
    };
    assert_eq!(chosen(few), CalibrationModel::Separable);
    let own = coefficients([2, 2, 7], 10);
    let tilting = record(&places(100, 11), |i| force(&own, i));
    assert_eq!(chosen(tilting), CalibrationModel::Coupled);
}
