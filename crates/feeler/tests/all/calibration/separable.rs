//! Separable model: three cubic curves, continued as straight lines beyond their ranges.

use super::element::{RANGES, fitted, inputs, moments, places, record};
use feeler::sensor::calibration::{
    Calibration, CalibrationModel, ForceCurve, ForceMap, ForceValidity, ModelChoice,
    RelativeMoments,
};
use feeler::sensor::moments::ElementMoments;
use glam::{DVec2, DVec3};

/// Coefficients of growth, x and y.
const CURVES: [[f64; 3]; 3] = [[2.0, 0.7, -0.4], [0.3, 0.02, 0.01], [0.2, -0.03, 0.004]];

fn cubic([a, b, c]: [f64; 3], s: f64) -> f64 {
    a * s + b * s.powi(2) + c * s.powi(3)
}

fn force(inputs: RelativeMoments) -> DVec3 {
    DVec3::new(
        cubic(CURVES[1], inputs.displacement.x),
        cubic(CURVES[2], inputs.displacement.y),
        cubic(CURVES[0], inputs.growth),
    )
}

fn calibration() -> Calibration {
    fitted(&[record(&places(40, 1), force)], ModelChoice::Separable).expect("a calibration")
}

fn curves(calibration: &Calibration) -> [ForceCurve; 3] {
    let ForceMap::Separable(map) = calibration.elements[0].map.clone() else {
        panic!("the separable model")
    };
    [map.normal, map.shear_x, map.shear_y]
}

#[test]
fn the_fit_recovers_cubic_curves() {
    let calibration = calibration();
    assert_eq!(calibration.model(), CalibrationModel::Separable);
    assert_eq!(
        calibration.elements[0].map.model(),
        CalibrationModel::Separable
    );
    for (axis, curve) in curves(&calibration).into_iter().enumerate() {
        for (found, expected) in curve.coefficients.into_iter().zip(CURVES[axis]) {
            // Rounding of a small, well-conditioned problem.
            assert!((found - expected).abs() < 1e-9, "{curve:?}");
        }
        for (found, expected) in curve.range.into_iter().zip(RANGES[axis]) {
            assert!((found - expected).abs() < 1e-9, "{curve:?}");
        }
    }
    let ranges = calibration.elements[0].map.ranges();
    assert_eq!(ranges, curves(&calibration).map(|curve| curve.range));
}

#[test]
fn loads_outside_the_fit_are_measured_exactly() {
    let calibration = calibration();
    let unseen = places(30, 2);
    let seen: Vec<ElementMoments> = unseen.iter().map(|&inputs| moments(inputs)).collect();
    for (inputs, moments) in unseen.iter().zip(seen) {
        let mut forces = [DVec3::NAN];
        calibration.forces(&[moments], &mut forces);
        assert!(forces[0].distance(force(*inputs)) < 1e-9, "{inputs:?}");
        let mut validity = [ForceValidity::Dark];
        calibration.validity(&[moments], &mut validity);
        assert_eq!(validity, [ForceValidity::Calibrated]);
    }
    assert_eq!(
        calibration.elements[0]
            .map
            .force(RelativeMoments::default()),
        DVec3::ZERO
    );
}

/// Ranges of loads that all press in one direction include zero.
#[test]
fn ranges_include_zero() {
    let pressed: Vec<RelativeMoments> = places(60, 3)
        .into_iter()
        .filter(|i| i.growth > 0.1 && i.displacement.x < -0.1 && i.displacement.y > 0.1)
        .collect();
    let calibration =
        fitted(&[record(&pressed, force)], ModelChoice::Separable).expect("a calibration");
    let [normal, x, y] = curves(&calibration).map(|curve| curve.range);
    assert_eq!((normal[0], x[1], y[0]), (0.0, 0.0, 0.0));
}

#[test]
fn beyond_its_loads_a_curve_continues_with_its_mean_slope() {
    for curve in curves(&calibration()) {
        let [low, high] = curve.range;
        let slope = (curve.force(high) - curve.force(low)) / (high - low);
        for beyond in [1e-3, 0.5, 70.0] {
            for (end, way) in [(low, -beyond), (high, beyond)] {
                let expected = curve.force(end) + way * slope;
                let found = curve.force(end + way);
                // Rounding of sums of up to 70 N.
                assert!((found - expected).abs() < 1e-10, "{found} {expected}");
            }
        }
        // Far beyond the range, forces stay finite and keep their sign.
        for (input, sign) in [(1e300, slope), (f64::INFINITY, slope), (-1e300, -slope)] {
            let force = curve.force(input);
            assert!(
                force.is_finite() && force * sign > 0.0,
                "{force} N at {input}"
            );
            // A million widths exceed any reading.
            let farthest = (1e6 * (high - low) * slope).abs();
            assert!(
                (force.abs() / farthest - 1.0).abs() < 1e-5,
                "{force} N at {input}"
            );
        }
        assert!(curve.force(f64::NAN).is_nan());
    }
}

#[test]
fn forces_are_calibrated_up_to_a_tenth_of_the_range_beyond_its_ends() {
    let calibration = calibration();
    let element = &calibration.elements[0];
    let validity = |at: [f64; 3]| element.validity(&moments(inputs(at)));
    for (axis, [low, high]) in RANGES.into_iter().enumerate() {
        let width = high - low;
        let at = |value: f64| {
            let mut at = [0.0; 3];
            at[axis] = value;
            at
        };
        for (share, expected) in [
            (0.09, ForceValidity::Calibrated),
            (0.11, ForceValidity::Extrapolated),
        ] {
            assert_eq!(validity(at(low - share * width)), expected, "{axis}");
            assert_eq!(validity(at(high + share * width)), expected, "{axis}");
        }
    }
    assert_eq!(validity([-0.49, 0.0, 0.0]), ForceValidity::Extrapolated);
    assert_eq!(validity([-0.51, 0.0, 0.0]), ForceValidity::Dark);
    assert_eq!(validity([f64::NAN, 0.0, 0.0]), ForceValidity::Dark);
    assert_eq!(validity([0.1, f64::NAN, 0.0]), ForceValidity::Dark);
    assert_eq!(validity([0.1, 0.0, f64::INFINITY]), ForceValidity::Dark);
}

#[test]
fn moments_are_relative_to_the_unloaded_ones() {
    let unloaded = ElementMoments {
        integrated_gray: 50.0,
        centroid: DVec2::new(0.5, -1.0),
    };
    let now = ElementMoments {
        integrated_gray: 75.0,
        centroid: DVec2::new(0.75, -1.5),
    };
    let relative = RelativeMoments::relative(&now, unloaded.integrated_gray, unloaded.centroid);
    assert_eq!(relative, inputs([0.5, 0.25, -0.5]));
}
