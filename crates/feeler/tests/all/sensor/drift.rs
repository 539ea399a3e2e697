//! Bounds of the drift correction: how much change of an element is attributed to creep.

use feeler::sensor::calibration::{
    CALIBRATION_VERSION, Calibration, CalibrationTarget, CoupledMap, ElementCalibration,
    ElementQuality, ForceMap, ForceUnit, FullScale, LengthUnit,
};
use feeler::sensor::forces::{DriftConfig, DriftCorrection};
use feeler::sensor::moments::ElementMoments;
use glam::DVec2;

const ELEMENTS: usize = 12;
const GRAY: f64 = 1e-3;
/// Calibrated ranges of displacements (m); the narrowest one counts.
const X_RANGE: [f64; 2] = [-3e-4, 3e-4];
const Y_RANGE: [f64; 2] = [-2e-4, 3e-4];

fn rest_of(element: usize) -> DVec2 {
    1e-5 * DVec2::new(element as f64, -2.0)
}

fn calibration() -> Calibration {
    let element = |element| ElementCalibration {
        unloaded_gray: GRAY,
        unloaded_centroid: rest_of(element),
        map: ForceMap::Coupled(CoupledMap {
            growth_range: [0.0, 2.0],
            x_range: X_RANGE,
            y_range: Y_RANGE,
            normal: vec![1.0, 0.0],
            shear_x: vec![1.0, 0.0],
            shear_y: vec![1.0, 0.0],
        }),
        quality: ElementQuality::default(),
    };
    Calibration {
        version: CALIBRATION_VERSION,
        force_unit: ForceUnit::Newton,
        full_scale: FullScale::default(),
        loads_confirmed: false,
        made_for: CalibrationTarget::layout("twelve elements", ELEMENTS, LengthUnit::Metre),
        elements: (0..ELEMENTS).map(element).collect(),
    }
}

/// Moments of one element after drift correction, if it creeps to `gain` and a displacement `moved` (m) over `frames`
/// frames while the others do not change.
///
/// Returns its growth and its displacement from rest.
fn left_of_creep(gain: f64, moved: DVec2, frames: u32) -> (f64, DVec2) {
    let config = DriftConfig {
        tolerance: 0.03,
        displacement_tolerance: 0.02,
        gain_rate: 0.2,
        rezero_rate: 0.1,
    };
    let mut correction = DriftCorrection::new(config, &calibration());
    let crept = 5;
    let mut left = (f64::NAN, DVec2::NAN);
    for frame in 0..=frames {
        let part = f64::from(frame) / f64::from(frames);
        let mut moments: Vec<_> = (0..ELEMENTS)
            .map(|element| ElementMoments {
                integrated_gray: GRAY,
                centroid: rest_of(element),
            })
            .collect();
        moments[crept].integrated_gray *= 1.0 + part * (gain - 1.0);
        moments[crept].centroid += part * moved;
        correction.correct(&mut moments);
        left = (
            moments[crept].integrated_gray / GRAY - 1.0,
            moments[crept].centroid - rest_of(crept),
        );
    }
    left
}

/// Displacement up to which an element counts as unmoved (m): 2 % of the narrowest range.
const UNMOVED: f64 = 0.02 * (Y_RANGE[1] - Y_RANGE[0]);

#[test]
fn creep_within_the_bounds_is_corrected() {
    let direction = DVec2::new(0.6, -0.8);
    let (growth, displacement) = left_of_creep(1.04, 1.5 * UNMOVED * direction, 2000);
    // The correction lags by ten of 2000 frames, half a percent of the creep.
    assert!(growth.abs() < 0.006 * 0.04, "{growth}");
    let left = displacement.length() / UNMOVED;
    assert!(left < 0.006 * 1.5, "{left} times UNMOVED");
}

#[test]
fn a_displacement_beyond_the_bound_is_not_corrected_at_any_rate() {
    let direction = DVec2::new(0.6, -0.8);
    let (_, displacement) = left_of_creep(1.0, 6.0 * UNMOVED * direction, 6000);
    // Two of the six are corrected; a sideways push must not become the rest position.
    let expected = 4.0 * UNMOVED * direction;
    let error = displacement.distance(expected) / UNMOVED;
    assert!(error < 1e-9, "expected {expected} m, got {displacement} m");
}

#[test]
fn a_gain_beyond_the_bounds_is_not_corrected_at_any_rate() {
    for (gain, own, others) in [(1.2, 1.05, 0.95), (0.8, 0.95, 1.05)] {
        let (growth, _) = left_of_creep(gain, DVec2::ZERO, 6000);
        // Only the product of the common gain and an element's own gain is observable. In the worst case the other
        // elements end at the opposite bound, and the common gain compensates for it.
        let least = gain * others / own - 1.0;
        let share = growth / least;
        assert!(
            share > 1.0 - 1e-9,
            "gain {gain}: expected at least {least}, got {growth}"
        );
    }
}
