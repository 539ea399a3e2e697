//! The coupled model: what its coefficients stand for, how many it takes, and which model is the better one.

use super::element::{RANGES, fitted, inputs, places, record};
use feeler::sensor::calibration::ModelChoice;
use feeler::sensor::calibration::{CalibrationModel, CoupledMap, ForceMap, RelativeMoments};
use feeler::sensor::calibration::{NORMAL_ORDERS, SHEAR_ORDERS};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Exponents of growth, x and y in the terms of `F_z`. Their order is that of the coefficients in every calibration file.
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

/// Exponents of growth, of the displacement along a shear force and of that across it.
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

/// RelativeMoments over their largest magnitude in `RANGES`: growth, x, y.
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

/// The force at `inputs` of a map with these coefficients of `F_x`, `F_y`, `F_z`.
fn force([x, y, z]: &[Vec<f64>; 3], inputs: RelativeMoments) -> DVec3 {
    let [g, u, v] = scaled(inputs);
    DVec3::new(
        sum(&SHEAR, x, [g, u, v]),
        sum(&SHEAR, y, [g, v, u]),
        sum(&NORMAL, z, [g, u, v]),
    )
}

/// That many coefficients of each component, of magnitudes from 0.5 to 1.
fn coefficients(orders: [usize; 3], seed: u64) -> [Vec<f64>; 3] {
    let mut rng = Pcg64::seed_from_u64(seed);
    orders.map(|order| {
        let one = |n: usize| rng.random_range(0.5..1.0) * [1.0, -1.0][n % 2];
        (0..order).map(one).collect()
    })
}

/// Negates each component that decreases from the smallest to the largest value of its input, since such a calibration
/// is refused.
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
fn each_coefficient_is_that_of_its_power_of_the_scaled_inputs() {
    for term in 0..20 {
        let unit = |count: usize| (0..count).map(|n| f64::from(n == term)).collect();
        let own = [unit(17), unit(17), unit(20)];
        let map = map(own.clone());
        for inputs in places(20, 4) {
            let error = map.force(inputs).distance(force(&own, inputs));
            assert!(error < 1e-14, "term {term} at {inputs:?}: {error} N off");
        }
    }
}

/// With as many terms as there are in the force: no more, as they are not worth while, and no fewer.
#[test]
fn a_force_of_so_many_terms_gets_so_many_and_is_found_again() {
    for n in 0..4 {
        let orders = [SHEAR_ORDERS[n], SHEAR_ORDERS[3 - n], NORMAL_ORDERS[n]];
        let own = rising(coefficients(orders, n as u64));
        let mut rng = Pcg64::seed_from_u64(5);
        // Noise of at most a ten-thousandth of the force, so that exact data do not favour a longer model.
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
            // What is left of the noise in 300 loads, at a corner where twenty terms add up.
            assert!(error < 1e-4, "{error} N off at {inputs:?}");
        }
        let held_out = calibration.elements[0].quality.held_out;
        // RMS of the noise: 1e-4 / sqrt(3), and a tenth more for the error of the fit.
        assert!(held_out.rms.max_element() < 0.65e-4, "{held_out:?}");
        assert!(held_out.rms.min_element() > 0.5e-4, "{held_out:?}");
    }
}

#[test]
fn far_beyond_its_loads_a_force_is_finite_and_not_a_number_stays_so() {
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

/// The better one of held-out loads; the separable one where loads do not suffice for the other.
#[test]
fn the_model_that_predicts_better_is_taken() {
    let separable = |i: RelativeMoments| {
        let [g, x, y] = scaled(i);
        // What the coupled model has no terms for.
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
