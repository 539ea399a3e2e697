//! Wrench calibration files are read as written, or rejected.

use super::world::{ELEMENTS, made_for, samples};
use feeler::sensor::fingertip::{CalibrationTarget, LengthUnit};
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::wrench::{WrenchCalibration, WrenchEstimator, fit};
use glam::DVec2;
use proptest::prelude::*;
use std::sync::LazyLock;

static TEXT: LazyLock<String> = LazyLock::new(|| {
    let fit = fit(made_for(), &["a".into()], &samples(60, 0, 1.0, 1), false).expect("a fit");
    fit.calibration.to_toml().expect("text")
});

#[test]
fn wrench_calibrations_survive_a_round_trip() {
    let calibration = WrenchCalibration::from_toml(&TEXT).unwrap();
    assert_eq!(calibration.to_toml().unwrap(), *TEXT);
    assert!(WrenchCalibration::is_kind(&TEXT) && !WrenchCalibration::is_kind("version = 2"));
    calibration.verify_target(&made_for()).unwrap();
    let other = CalibrationTarget::layout("another", ELEMENTS, LengthUnit::Pixel);
    assert!(calibration.verify_target(&other).is_err());
}

#[test]
fn errors_name_the_invalid_value() {
    for (from, to, words) in [
        ("version = 1", "version = 7", "version = 7"),
        ("kind = \"wrench\"", "kind = \"other\"", "kind = \"other\""),
        (
            "elements = 16",
            "elements = 17",
            "model.elements: expected 17, got 16",
        ),
        ("intercept = ", "intercept = inf # ", "f_x.weights = inf"),
        ("penalty = ", "penalty = -1.0 # ", "f_x.penalty = -1"),
        ("limit = ", "limit = nan # ", "novelty.limit = NaN"),
        ("rest = ", "rest = 0.0 # ", "novelty.rest = 0"),
        ("gray = ", "gray = 0.0 # ", "gray = 0"),
        ("axis = \"f_y\"", "axis = \"f_x\"", "each once"),
        ("axis = \"f_y\"", "axis = \"f_w\"", "f_w"),
    ] {
        assert!(TEXT.contains(from), "{from}");
        let text = match from {
            // In the model, after the qualities.
            from if from.starts_with("axis") => {
                let (before, model) = TEXT.split_once("[[model.axes]]").unwrap();
                format!("{before}[[model.axes]]{}", model.replacen(from, to, 1))
            }
            from => TEXT.replacen(from, to, 1),
        };
        let message = WrenchCalibration::from_toml(&text).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
    assert!(WrenchCalibration::from_toml("").is_err());
}

proptest! {
    // Few cases, because each parses a whole file.
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// A file with changed numbers is rejected, or gives finite results for any readings.
    #[test]
    fn changed_numbers_are_rejected_or_give_finite_results(
        changes in proptest::collection::vec((any::<proptest::sample::Index>(), prop_oneof![
            Just("0"), Just("-1"), Just("nan"), Just("inf"), Just("1e300"), Just("-1e14"), Just("1e-300"), Just("5"), Just("\"x\""), Just("[]"),
        ]), 1..4),
        gray in prop_oneof![Just(0.0), Just(1e-300), Just(1e300), -1e6..1e6],
        place in prop_oneof![Just(1e300), -1e3..1e3],
    ) {
        let mut lines: Vec<String> = TEXT.lines().map(str::to_owned).collect();
        for (index, value) in changes {
            let line = index.get(&lines).clone();
            let at = lines.iter().position(|other| *other == line).unwrap();
            if let Some((key, _)) = line.split_once(" = ") {
                lines[at] = format!("{key} = {value}");
            }
        }
        let Ok(calibration) = WrenchCalibration::from_toml(&lines.join("\n")) else {
            return Ok(());
        };
        let mut estimator = WrenchEstimator::new(calibration).unwrap();
        let moments = ElementMoments { integrated_gray: gray, centroid: DVec2::splat(place) };
        for count in [0, 1, ELEMENTS, 2 * ELEMENTS] {
            let estimate = estimator.estimate_with(|input| *input = vec![Some(moments); count]);
            prop_assert!(estimate.components.iter().flatten().all(|c| c.is_finite()), "{estimate:?}");
            prop_assert!(!estimate.novelty.is_nan() || !estimate.valid);
        }
    }
}
