//! Calibration files: contents and rejected values.

use super::element::{fitted, made_for, places, record};
use feeler::sensor::calibration::{
    Calibration, CalibrationTarget, ForceMap, LengthUnit, ModelChoice,
};
use feeler::sensor::fingertip::{FingertipConfig, sha256};
use glam::DVec3;

fn calibration(choice: ModelChoice) -> Calibration {
    let record = record(&places(60, 1), |i| {
        DVec3::new(i.displacement.x, i.displacement.y, 2.0 * i.growth)
    });
    fitted(&[record.clone(), record], choice).expect("a calibration")
}

#[test]
fn calibrations_survive_a_round_trip_through_a_file() {
    for choice in [ModelChoice::Separable, ModelChoice::Coupled] {
        let calibration = calibration(choice);
        let text = calibration.to_toml().expect("text");
        assert_eq!(
            Calibration::from_toml(&text).expect("a calibration"),
            calibration
        );
    }
}

/// Error message for a calibration after `change`.
fn refused(choice: ModelChoice, change: impl Fn(&mut Calibration)) -> String {
    let mut calibration = calibration(choice);
    change(&mut calibration);
    let text = calibration.to_toml().expect("text");
    Calibration::from_toml(&text)
        .expect_err("refused")
        .to_string()
}

#[test]
fn invalid_unloaded_moments_are_rejected() {
    type Change = fn(&mut Calibration);
    let cases: [(Change, &str); 6] = [
        (|c| c.version = 1, "version"),
        (|c| c.elements.truncate(1), "calibrations"),
        (
            |c| c.elements[1].unloaded_gray = 0.0,
            "unloaded_gray must be positive",
        ),
        (
            |c| c.elements[1].unloaded_gray = 1e-101,
            "unloaded_gray must be positive",
        ),
        (
            |c| c.elements[1].unloaded_gray = f64::INFINITY,
            "unloaded_gray must be positive",
        ),
        (
            |c| c.elements[1].unloaded_centroid.y = f64::NAN,
            "unloaded_centroid must be finite",
        ),
    ];
    for (change, words) in cases {
        let message = refused(ModelChoice::Separable, change);
        assert!(message.contains(words), "{words}: {message}");
    }
}

#[test]
fn invalid_curves_are_rejected() {
    let changed = |change: fn(&mut [f64; 2], &mut [f64; 3])| {
        refused(ModelChoice::Separable, move |calibration| {
            let ForceMap::Separable(map) = &mut calibration.elements[1].map else {
                panic!("the separable model")
            };
            change(&mut map.shear_y.range, &mut map.shear_y.coefficients);
        })
    };
    for message in [
        changed(|range, _| *range = [0.1, 1.0]),
        changed(|range, _| *range = [-1.0, -0.1]),
        changed(|range, _| *range = [0.0, 0.0]),
        changed(|range, _| range[0] = f64::NEG_INFINITY),
        changed(|range, _| range[1] = f64::INFINITY),
        changed(|range, _| range[1] = f64::NAN),
    ] {
        assert!(message.contains("shear_y.range"), "{message}");
    }
    for message in [
        changed(|_, c| c[1] = f64::NAN),
        changed(|_, c| c[2] = f64::INFINITY),
        // Finite at both ends, but the difference over a narrow range is infinite.
        changed(|range, c| (*range, *c) = ([-1e-20, 1e-20], [1e300, 0.0, 1e308 * 1e40])),
    ] {
        assert!(message.contains("shear_y.coefficients"), "{message}");
    }
    // A range may begin or end at 0.
    for range in [[0.0, 1.0], [-1.0, 0.0]] {
        let mut calibration = calibration(ModelChoice::Separable);
        let ForceMap::Separable(map) = &mut calibration.elements[1].map else {
            panic!("the separable model")
        };
        map.shear_y.range = range;
        let text = calibration.to_toml().expect("text");
        assert!(Calibration::from_toml(&text).is_ok(), "{range:?}");
    }
}

#[test]
fn invalid_coupled_maps_are_rejected() {
    let changed = |change: fn(&mut feeler::sensor::calibration::CoupledMap)| {
        refused(ModelChoice::Coupled, move |calibration| {
            let ForceMap::Coupled(map) = &mut calibration.elements[1].map else {
                panic!("the coupled model")
            };
            change(map);
        })
    };
    for (message, words) in [
        (
            changed(|m| m.growth_range = [0.1, 1.0]),
            "growth_range must be increasing",
        ),
        (
            changed(|m| m.x_range = [-1.0, -0.1]),
            "x_range must be increasing",
        ),
        (
            changed(|m| m.y_range = [0.0, 0.0]),
            "y_range must be increasing",
        ),
        (
            changed(|m| m.y_range[0] = f64::NEG_INFINITY),
            "y_range must be increasing",
        ),
        (
            changed(|m| m.y_range[1] = f64::INFINITY),
            "y_range must be increasing",
        ),
        (
            changed(|m| m.normal.truncate(1)),
            "normal to have one of [2, 7, 12, 20] terms",
        ),
        (
            changed(|m| m.shear_x.push(0.0)),
            "shear_x to have one of [2, 5, 10, 17] terms",
        ),
        (
            changed(|m| m.shear_y[1] = f64::NAN),
            "shear_y to have finite coefficients",
        ),
        (
            changed(|m| m.shear_y[1] = -1.1e100),
            "shear_y to have finite coefficients",
        ),
    ] {
        assert!(message.contains(words), "{words}: {message}");
    }
    for (range, coefficient) in [([0.0, 1.0], 1e100), ([-1.0, 0.0], -1e100)] {
        let mut calibration = calibration(ModelChoice::Coupled);
        let ForceMap::Coupled(map) = &mut calibration.elements[1].map else {
            panic!("the coupled model")
        };
        (map.x_range, map.normal[0]) = (range, coefficient);
        // Larger than any force that an element can bear.
        calibration.loads_confirmed = true;
        let text = calibration.to_toml().expect("text");
        assert!(Calibration::from_toml(&text).is_ok(), "{range:?}");
    }
}

/// A fingertip matches its own calibration and differs after a change of any part.
#[test]
fn a_calibration_matches_only_its_own_sensor() {
    let config = FingertipConfig::default();
    let here = CalibrationTarget::fingertip(&config).expect("a fingertip");
    assert_eq!(here.elements, 41);
    assert!(here.verify_same(&here.clone()).is_ok());
    type Change = fn(&mut FingertipConfig);
    let cases: [(Change, &str); 3] = [
        (|c| c.layout.dome_radius = 0.02, "the layout"),
        (|c| c.camera.standoff = 0.001, "the camera"),
        (
            |c| c.moments.dark_level = 3,
            "the configuration of the moments",
        ),
    ];
    let mut calibration = calibration(ModelChoice::Separable);
    calibration.made_for = here.clone();
    assert!(calibration.verify_target(&config).is_ok());
    for (change, words) in cases {
        let mut other = config.clone();
        change(&mut other);
        let message = calibration
            .verify_target(&other)
            .expect_err("refused")
            .to_string();
        assert!(message.contains(words), "{words}: {message}");
    }
    let message = here
        .verify_same(&made_for(41))
        .expect_err("refused")
        .to_string();
    assert!(
        message.contains("located layout") && message.contains("geometry"),
        "{message}"
    );
    let pixels = CalibrationTarget::layout("a text", 41, LengthUnit::Pixel);
    let message = pixels
        .verify_same(&made_for(41))
        .expect_err("refused")
        .to_string();
    assert!(message.contains("sha256"), "{message}");
}

#[test]
fn a_fingertip_with_another_hash_is_rejected() {
    let fingertip = CalibrationTarget::fingertip(&FingertipConfig::default()).expect("a fingertip");
    let with = |made_for: CalibrationTarget| {
        refused(ModelChoice::Separable, move |c| {
            c.made_for = made_for.clone()
        })
    };
    let mut other = fingertip.clone();
    other.sha256 = "0".repeat(64);
    assert!(with(other).contains(&fingertip.sha256));
    let mut other = fingertip.clone();
    other.elements = 2;
    assert!(with(other).contains("made_for.elements"));
}

/// Hashes of the empty text and of the example in FIPS 180-4.
#[test]
fn hashes_are_sha_256() {
    assert_eq!(
        sha256(""),
        "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"
    );
    assert_eq!(
        sha256("abc"),
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    );
}
