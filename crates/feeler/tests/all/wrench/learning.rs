//! Learned wrenches compared with the law that generated the images, and rejected data.

use super::world::{ELEMENTS, chain, layout, made_for, picture, read, samples};
use assert_no_alloc::assert_no_alloc;
use feeler::sensor::image::Exposure;
use feeler::sensor::wrench::{AXES, WrenchAxis, WrenchError, WrenchEstimator, WrenchSample, fit};
use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn names(count: usize) -> Vec<String> {
    (0..count)
        .map(|index| format!("recording {index}"))
        .collect()
}

fn fitted(samples: &[WrenchSample], recordings: usize) -> WrenchEstimator {
    let fit = fit(made_for(), &names(recordings), samples, false).expect("a fit");
    WrenchEstimator::new(fit.calibration).expect("an estimator")
}

/// Maximum error (N). Over a spot's 80 lit pixels, whose weights add up to half of them, noise of 2 of 120 grey
/// levels is about 0.3 % of its growth; a newton changes 16 spots by about 3 % each. The best combination leaves 0.3
/// / (3 * sqrt(16)) = 0.03 N of noise. The contributions of ridge regression and of the measurement's noise of 0.01 N
/// stay below three times that, over forces of 3 N.
const TOLERANCE: f64 = 0.09;

#[test]
fn forces_are_estimated_in_another_recording_with_a_dimmer_lamp() {
    let mut estimator = fitted(&samples(150, 0, 1.0, 1), 1);
    let mut chain = chain();
    let mut random = Pcg64::seed_from_u64(9);
    let mut errors = [0.0_f64; 3];
    let mut valid = 0;
    for lamp in [1.0, 0.85] {
        for _ in 0..40 {
            let force = DVec3::new(
                random.random_range(-1.2..1.2),
                random.random_range(-1.2..1.2),
                random.random_range(-2.7..-0.3),
            );
            let readings = read(&mut chain, &picture(force, lamp, &mut random));
            let estimate = assert_no_alloc(|| estimator.estimate(&readings));
            valid += u32::from(estimate.valid);
            let error = estimate.force().unwrap() - force;
            for axis in 0..3 {
                errors[axis] += error[axis].powi(2) / 80.0;
            }
            assert_eq!(estimate.component(WrenchAxis::TorqueX), None);
        }
    }
    // More than nine tenths are as close to the calibration as nine tenths of the images it was fitted to.
    assert!(valid > 72, "{valid} of 80 are valid");
    for (axis, square) in errors.into_iter().enumerate() {
        assert!(
            square.sqrt() < TOLERANCE,
            "axis {axis}: {} N",
            square.sqrt()
        );
    }
}

#[test]
fn held_out_errors_predict_errors_on_later_images() {
    let both = [samples(100, 0, 1.0, 1), samples(60, 1, 1.1, 2)].concat();
    let fit = fit(made_for(), &names(2), &both, false).expect("a fit");
    assert!(
        fit.left_out.is_empty() && fit.unusable == 0,
        "{:?}",
        fit.left_out
    );
    let mut estimator = WrenchEstimator::new(fit.calibration.clone()).unwrap();
    let later = samples(200, 0, 1.0, 77);
    for quality in &fit.calibration.quality {
        let axis = quality.axis.index();
        let squares = later.iter().map(|sample| {
            let estimate = estimator.estimate_with(|input| input.clone_from(&sample.seen));
            (estimate.components[axis].unwrap() - sample.wrench[axis].unwrap()).powi(2)
        });
        let rmse = (squares.sum::<f64>() / later.len() as f64).sqrt();
        // Learned from four fifths, and tested on 160 images whose errors scatter by 1/sqrt(2 * 160) = 6 %; the bound
        // is three times that.
        let ratio = quality.blocks.rmse / rmse;
        assert!(
            (0.7..1.5).contains(&ratio),
            "{quality:?}: {rmse} N on later images"
        );
        assert!(quality.r2 > 0.95 && quality.recordings.len() == 2);
        let left_out = quality.recordings[1]
            .left_out
            .expect("another recording to learn from");
        assert!(left_out.rmse < 2.0 * TOLERANCE, "{left_out:?}");
    }
}

/// A twist brightens spots like the usual forces, and differs only in their displacement: 0.6 px on average, twice
/// that of a newton of shear. The novelty limit is 1.25 times the value that nine tenths of the calibration's images
/// reach.
#[test]
fn another_kind_of_load_is_invalid_even_if_brightness_is_usual() {
    let mut estimator = fitted(&samples(150, 0, 1.0, 1), 1);
    let mut chain = chain();
    let places: Vec<_> = layout().elements.iter().map(|e| e.centre_px).collect();
    let middle = places.iter().sum::<DVec2>() / places.len() as f64;
    let mut random = Pcg64::seed_from_u64(5);
    for turn in [-1.0, 1.0].repeat(10) {
        let force = DVec3::new(random.random_range(-1.0..1.0), 0.3, -1.5);
        let mut readings = read(&mut chain, &picture(force, 1.0, &mut random));
        assert!(estimator.estimate(&readings).valid);
        for (reading, place) in readings.iter_mut().zip(&places) {
            let centroid = reading.centroid.as_mut().expect("a lit spot");
            *centroid += turn * 0.02 * (*place - middle).perp();
        }
        let estimate = estimator.estimate(&readings);
        assert!(!estimate.valid, "{estimate:?}");
    }
}

#[test]
fn readings_unlike_the_calibration_are_invalid() {
    let mut estimator = fitted(&samples(120, 0, 1.0, 1), 1);
    let mut chain = chain();
    let mut random = Pcg64::seed_from_u64(3);
    let far = picture(DVec3::new(0.0, 0.0, -12.0), 1.0, &mut random);
    let estimate = estimator.estimate(&read(&mut chain, &far));
    assert!(!estimate.valid && estimate.novelty > 1.0 && estimate.force().is_some());

    let mut readings = read(&mut chain, &picture(-DVec3::Z, 1.0, &mut random));
    readings[3].exposure = Exposure::Saturated;
    let estimate = estimator.estimate(&readings);
    assert!(
        estimate.valid,
        "one element of {ELEMENTS} is saturated: {estimate:?}"
    );
    for reading in &mut readings[..4] {
        reading.exposure = Exposure::Saturated;
    }
    let estimate = estimator.estimate(&readings);
    assert!(
        !estimate.valid && estimate.components == [None; AXES],
        "{estimate:?}"
    );
    let estimate = estimator.estimate(&[]);
    assert!(
        !estimate.valid && estimate.components == [None; AXES],
        "{estimate:?}"
    );
}

#[test]
fn components_without_correlation_are_left_out_or_rejected() {
    let mut random = Pcg64::seed_from_u64(5);
    let mut all = samples(80, 0, 1.0, 1);
    for sample in &mut all {
        sample.wrench[5] = Some(random.random_range(-1.0..1.0));
        sample.wrench[3] = Some(0.25);
    }
    let found = fit(made_for(), &names(1), &all, false).expect("a fit");
    let left_out: Vec<_> = found.left_out.iter().map(|(axis, _)| *axis).collect();
    assert_eq!(left_out, [WrenchAxis::TorqueX, WrenchAxis::TorqueZ]);
    assert_eq!(found.calibration.model.axes.len(), 3);

    for sample in &mut all {
        let noise = sample.wrench[5];
        sample.wrench = [None; AXES];
        sample.wrench[0] = noise;
    }
    let refused = fit(made_for(), &names(1), &all, false).unwrap_err();
    assert!(
        matches!(refused, WrenchError::ExplainsNothing { .. }),
        "{refused}"
    );
    let kept = fit(made_for(), &names(1), &all, true).expect("a fit that is forced");
    assert!(!kept.calibration.quality[0].explains());

    let refused = fit(made_for(), &names(1), &all[..5], false).unwrap_err();
    assert!(
        matches!(refused, WrenchError::TooFew { actual: 5, .. }),
        "{refused}"
    );
    for sample in &mut all {
        sample.wrench = [None; AXES];
        sample.wrench[0] = Some(1.0);
    }
    let refused = fit(made_for(), &names(1), &all, false).unwrap_err();
    assert!(matches!(refused, WrenchError::Constant), "{refused}");
    let refused = fit(made_for(), &[], &all, false).unwrap_err();
    assert!(matches!(refused, WrenchError::Count { .. }), "{refused}");
}

#[test]
fn a_component_is_learned_from_the_samples_that_contain_it() {
    let mut all = samples(120, 0, 1.0, 1);
    for sample in &mut all[..50] {
        sample.wrench[0] = None;
        sample.seen[2] = None;
    }
    let fit = fit(made_for(), &names(1), &all, false).expect("a fit");
    let rows: Vec<_> = fit
        .calibration
        .quality
        .iter()
        .map(|q| q.blocks.rows)
        .collect();
    assert_eq!(rows, [70, 120, 120]);
    assert!(
        fit.calibration
            .quality
            .iter()
            .all(|quality| quality.r2 > 0.9)
    );
}
