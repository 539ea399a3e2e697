//! A target that depends on products of the modes of a displacement field.

use feeler::sensor::fingertip::{CalibrationTarget, LengthUnit};
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::wrench::{WrenchAxis, WrenchEstimator, WrenchSample, fit};
use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

const COLUMNS: usize = 6;
const ELEMENTS: usize = 30;
/// Maximum noise of a displacement (px).
const NOISE: f64 = 0.05;

/// Displacement of a marker in a field of three modes with these amplitudes (px). No marker is moved by both a and b along
/// the same axis, so that squares of displacements do not contain a b.
fn displacement(element: usize, [a, b, c]: [f64; 3]) -> DVec2 {
    let x = (element % COLUMNS) as f64 / COLUMNS as f64;
    let y = (element / COLUMNS) as f64 / (ELEMENTS / COLUMNS) as f64;
    DVec2::new(
        a * (TAU * x + 1.0).sin() + c * (TAU * y).cos(),
        b * (TAU * y + 1.0).sin(),
    )
}

/// Samples with force x = a and force z = a b (N), for random amplitudes.
fn samples(count: usize, seed: u64) -> Vec<WrenchSample> {
    let mut random = Pcg64::seed_from_u64(seed);
    let samples = (0..count).map(|_| {
        let q = [(); 3].map(|()| random.random_range(-1.0..1.0));
        let moments = |element: usize| {
            let noise = DVec2::new(
                random.random_range(-NOISE..NOISE),
                random.random_range(-NOISE..NOISE),
            );
            Some(ElementMoments {
                integrated_gray: 1000.0,
                centroid: DVec2::splat(50.0) + displacement(element, q) + noise,
            })
        };
        let mut wrench = [None; 8];
        wrench[WrenchAxis::ForceX.index()] = Some(q[0]);
        wrench[WrenchAxis::ForceZ.index()] = Some(q[0] * q[1]);
        WrenchSample {
            recording: 0,
            seen: (0..ELEMENTS).map(moments).collect(),
            wrench,
        }
    });
    samples.collect()
}

#[test]
fn products_of_modes_are_learned_where_they_matter() {
    let made_for = CalibrationTarget::layout("markers", ELEMENTS, LengthUnit::Pixel);
    let fit = fit(made_for, &["a".into()], &samples(200, 1), false).expect("a fit");
    let terms = |axis| fit.calibration.axis(axis).expect("a model").terms;
    // Force x is linear in the displacements.
    let [x, z] = [WrenchAxis::ForceX, WrenchAxis::ForceZ].map(terms);
    assert!(z.modes && !x.modes, "{x:?}, {z:?}");
    let text = fit.calibration.to_toml().unwrap();
    assert_eq!(
        feeler::sensor::wrench::WrenchCalibration::from_toml(&text).unwrap(),
        fit.calibration
    );
    let mut estimator = WrenchEstimator::new(fit.calibration).unwrap();
    let mut squares = 0.0;
    for sample in samples(100, 2) {
        let estimate = estimator.estimate_with(|input| input.clone_from(&sample.seen));
        let axis = WrenchAxis::ForceZ.index();
        squares += (estimate.components[axis].unwrap() - sample.wrench[axis].unwrap()).powi(2);
    }
    let rmse = (squares / 100.0).sqrt();
    // Each amplitude has the noise of 30 displacements, with a mean square of 1/2: 0.05 / sqrt(3) / sqrt(15) =
    // 0.007. The product of two amplitudes has 0.007 * sqrt(2 / 3) = 0.006; all terms of the regression share at most
    // four times that. Without products, only the mean could be predicted: 1/3.
    assert!(rmse < 0.024, "{rmse}");
}

#[test]
fn modes_that_no_component_uses_are_not_stored() {
    let mut samples = samples(200, 1);
    for sample in &mut samples {
        sample.wrench[WrenchAxis::ForceZ.index()] = None;
    }
    let made_for = CalibrationTarget::layout("markers", ELEMENTS, LengthUnit::Pixel);
    let fit = fit(made_for, &["a".into()], &samples, false).expect("a fit");
    assert!(!fit.calibration.to_toml().unwrap().contains("modes"));
}
