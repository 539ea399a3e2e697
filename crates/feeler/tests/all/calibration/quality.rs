//! Error statistics of calibrations, computed from synthetic readings.

use super::element::{CENTROID, GRAY, fitted, inputs, moments, places, record};
use feeler::sensor::calibration::{
    Calibration, CalibrationReport, CalibrationTarget, CycledReading, ElementQuality, Errors,
    FullScale, HeldOutError, LoadSample, ModelChoice, RelativeMoments,
    repeatability_and_hysteresis,
};
use feeler::sensor::fingertip::FingertipConfig;
use glam::DVec3;

/// Force that is linear in the inputs.
fn linear(i: RelativeMoments) -> DVec3 {
    DVec3::new(
        0.1 * i.displacement.x,
        0.2 * i.displacement.y,
        3.0 * i.growth,
    )
}

#[test]
fn held_out_errors_have_root_mean_square_and_maximum() {
    let full_scale = FullScale {
        normal: 2.0,
        shear: 0.5,
    };
    let errors = [DVec3::new(0.3, -0.1, 0.0), DVec3::new(-0.4, 0.1, 0.2)];
    let found = HeldOutError::of(&errors, full_scale);
    let expected = DVec3::new(0.125_f64.sqrt(), 0.1, 0.02_f64.sqrt());
    assert!(found.rms.distance(expected) < 1e-15, "{found:?}");
    assert_eq!(found.worst, DVec3::new(0.4, 0.1, 0.2));
    let percent = DVec3::new(80.0, 20.0, 10.0);
    assert!(found.worst_percent.distance(percent) < 1e-12, "{found:?}");
    let percent = expected * DVec3::new(200.0, 200.0, 50.0);
    assert!(found.rms_percent.distance(percent) < 1e-12, "{found:?}");
    assert_eq!(full_scale.components(), DVec3::new(0.5, 0.5, 2.0));
    let none = HeldOutError::of(&[], full_scale);
    assert_eq!(none, HeldOutError::default());
}

/// Repeatability and hysteresis of a series of loads along z and the readings under them (N).
fn series(loads: &[(f64, f64)]) -> (Option<DVec3>, Option<DVec3>) {
    let reading = |&(load, reading): &(f64, f64)| CycledReading {
        force: load * DVec3::Z,
        reading: reading * DVec3::new(1.0, 2.0, -1.0),
    };
    repeatability_and_hysteresis(&loads.iter().map(reading).collect::<Vec<_>>())
}

#[test]
fn repeatability_requires_a_load_applied_three_times() {
    assert_eq!(series(&[(1.0, 1.0), (2.0, 5.0), (1.0, 2.0)]), (None, None));
    // 1, 2, 3 have standard deviation 1; the load with the largest spread counts.
    let loads = [
        (1.0, 1.0),
        (2.0, 5.0),
        (1.0, 2.0),
        (2.0, 5.0),
        (1.0, 3.0),
        (2.0, 5.0),
    ];
    let (repeatability, _) = series(&loads);
    let found = repeatability.expect("repeatability");
    assert!(found.distance(DVec3::new(1.0, 2.0, 1.0)) < 1e-12, "{found}");
}

#[test]
fn hysteresis_requires_a_load_reached_twice_from_each_side() {
    // Readings at 1 N are 1.0 and 1.2 from below (mean 1.1), and 1.5 and 1.9 from above (mean 1.7).
    let cycle = [(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (1.0, 1.5)];
    let again = [(0.0, 0.0), (1.0, 1.2), (2.0, 2.0), (1.0, 1.9)];
    let (_, hysteresis) = series(&[cycle, again].concat());
    let found = hysteresis.expect("hysteresis");
    assert!(
        found.distance(0.6 * DVec3::new(1.0, 2.0, 1.0)) < 1e-12,
        "{found}"
    );
    let (_, once) = series(&cycle);
    assert_eq!(once, None);
    // Two readings from below and one from above do not give a pair of means.
    let one_sided = [
        (0.0, 0.0),
        (1.0, 1.0),
        (0.0, 0.0),
        (1.0, 1.0),
        (2.0, 2.0),
        (1.0, 1.5),
    ];
    assert_eq!(series(&one_sided).1, None);
    // A repeated load has no direction of approach.
    let same = [(0.0, 0.0), (1.0, 1.0), (1.0, 9.0), (0.0, 0.0), (1.0, 1.0)];
    assert_eq!(
        series(&[&same[..], &[(2.0, 0.0), (1.0, 1.0)]].concat()).1,
        None
    );
}

/// Calibration of two elements with these qualities.
fn two(qualities: [ElementQuality; 2]) -> Calibration {
    let records = [(); 2].map(|()| record(&places(20, 1), linear));
    let mut calibration = fitted(&records, ModelChoice::Separable).expect("a calibration");
    for (element, quality) in calibration.elements.iter_mut().zip(qualities) {
        element.quality = quality;
    }
    calibration
}

fn qualities() -> [ElementQuality; 2] {
    let full_scale = FullScale::default();
    let first = ElementQuality {
        held_out: HeldOutError::of(&[DVec3::new(0.03, 0.0, 0.01)], full_scale),
        repeatability: Some(DVec3::new(0.001, 0.002, 0.003)),
        ..ElementQuality::default()
    };
    let second = ElementQuality {
        held_out: HeldOutError::of(&[DVec3::new(0.04, 0.02, 0.0)], full_scale),
        repeatability: Some(DVec3::new(0.004, 0.001, 0.001)),
        hysteresis: Some(DVec3::new(0.005, 0.0, 0.0)),
        resolution: None,
    };
    [first, second]
}

#[test]
fn summary_averages_squared_errors_and_takes_the_largest_of_other_measures() {
    let all = Errors::over(&two(qualities()).elements);
    let rms = DVec3::new(0.0025, 0.0004, 0.0001) / 2.0;
    assert!(all.rms.distance(rms.map(f64::sqrt)) < 1e-15, "{all:?}");
    assert_eq!(all.worst, DVec3::new(0.04, 0.02, 0.01));
    assert_eq!(all.repeatability, DVec3::new(0.004, 0.002, 0.003));
    assert_eq!(all.hysteresis, DVec3::new(0.005, 0.0, 0.0));
    assert_eq!(all.resolution, DVec3::ZERO);
    assert_eq!(Errors::over(&[]), Errors::default());
}

#[test]
fn without_rings_the_report_has_a_line_per_element() {
    let calibration = two(qualities());
    let report = CalibrationReport::new(&calibration).to_string();
    let line = |name: &str| {
        let line = report.lines().find(|line| line.starts_with(name));
        line.unwrap_or_else(|| panic!("no {name} in\n{report}"))
    };
    assert!(
        line("separable").contains("1 N in x and y, 2 N in z"),
        "{report}"
    );
    let second: Vec<&str> = line("element 1").split_whitespace().collect();
    let expected = [
        "element", "1", "0.0400", "(", "4.00", "%)", "0.0400", "(", "4.00", "%)", "0.0200", "(",
        "2.00", "%)", "0.0200", "(", "2.00", "%)", "0.0000", "(", "0.00", "%)", "0.0000", "(",
        "0.00", "%)",
    ];
    assert_eq!(second, expected);
    assert!(line("element 0").contains("0.0300 ( 3.00 %)"), "{report}");
    assert!(
        line("repeatability").contains("4.0, 2.0, 3.0 mN"),
        "{report}"
    );
    assert!(line("hysteresis").contains("5.0, 0.0, 0.0 mN"), "{report}");
    assert!(!report.contains("resolution"), "{report}");
}

#[test]
fn unloaded_images_determine_rest_moments_and_resolution() {
    let mut record = record(&places(20, 1), linear);
    let ripple = [-0.01, 0.01, -0.01, 0.01, 0.0];
    record.unloaded = ripple.map(|r| moments(inputs([r, 10.0 * r, 0.0]))).into();
    let calibration = fitted(&[record], ModelChoice::Separable).expect("a calibration");
    let element = &calibration.elements[0];
    assert!((element.unloaded_gray / GRAY - 1.0).abs() < 1e-12);
    assert!(element.unloaded_centroid.distance(CENTROID) < 1e-12);
    let found = element.quality.resolution.expect("a resolution");
    // Three standard deviations of the ripple: 4 of 5 images are off the mean by 0.01, so sqrt(4e-4 / 4) = 0.01.
    let expected = 3.0 * 0.01 * DVec3::new(0.1 * 10.0, 0.0, 3.0);
    assert!(found.distance(expected) < 1e-9, "{found}");
}

#[test]
fn held_out_and_cycled_loads_are_evaluated_with_the_fit() {
    let mut record = record(&places(20, 1), linear);
    let at = inputs([0.4, 1.0, -0.5]);
    let off = |by: DVec3| LoadSample {
        force: linear(at) - by,
        moments: moments(at),
    };
    record.held_out = vec![
        off(DVec3::new(0.05, 0.0, 0.0)),
        off(DVec3::new(0.0, 0.0, -0.1)),
    ];
    record.cycled = [0.2, 0.3, 0.4]
        .map(|growth| LoadSample {
            force: DVec3::Z,
            moments: moments(inputs([growth, 0.0, 0.0])),
        })
        .into();
    let calibration = fitted(&[record], ModelChoice::Separable).expect("a calibration");
    let quality = calibration.elements[0].quality;
    let worst = DVec3::new(0.05, 0.0, 0.1);
    assert!(quality.held_out.worst.distance(worst) < 1e-9, "{quality:?}");
    let spread = quality.repeatability.expect("repeatability");
    assert!(spread.distance(0.3 * DVec3::Z) < 1e-9, "{spread}");
    assert_eq!(quality.hysteresis, None);
    assert_eq!(quality.resolution, None);
}

/// Rings of 1, 8, 12 and 20 elements whose errors equal the ring's number.
#[test]
fn with_rings_the_report_has_a_line_per_ring() {
    let mut calibration = two(qualities());
    let element = calibration.elements[0].clone();
    let of_ring = |(ring, count): (usize, usize)| {
        let mut element = element.clone();
        let error = 0.01 * (1 + ring) as f64 * DVec3::Z;
        element.quality = ElementQuality {
            held_out: HeldOutError::of(&[error], FullScale::default()),
            ..ElementQuality::default()
        };
        vec![element; count]
    };
    calibration.elements = [1, 8, 12, 20]
        .into_iter()
        .enumerate()
        .flat_map(of_ring)
        .collect();
    calibration.made_for =
        CalibrationTarget::fingertip(&FingertipConfig::default()).expect("a fingertip");
    let rings = CalibrationReport::new(&calibration).rings();
    assert_eq!(rings.len(), 4);
    for (n, ring) in rings.iter().enumerate() {
        assert!(
            (ring.worst.z - 0.01 * (1 + n) as f64).abs() < 1e-15,
            "{ring:?}"
        );
    }
    let mut report = CalibrationReport::new(&calibration);
    let lines = |report: &CalibrationReport| {
        let text = report.to_string();
        ["ring ", "element "].map(|name| text.lines().filter(|l| l.starts_with(name)).count())
    };
    assert_eq!(lines(&report), [4, 0]);
    report.verbose = true;
    assert_eq!(lines(&report), [4, 41]);
}
