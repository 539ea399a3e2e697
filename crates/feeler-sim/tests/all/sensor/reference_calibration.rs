//! The committed calibration is reproducible from the reference experiment's fingertip.

use super::optics::of_experiment;
use crate::experiment_file::text;
use feeler::sensor::calibration::{Calibration, ForceCurve, ForceMap};
use feeler_sim::bench::{CalibrationBenchConfig, calibrate_simulated};

/// Relative tolerance of forces.
///
/// Image noise is drawn with integers, but the geometry uses sine and cosine, which differ in the last bit between
/// machines; the fit's condition number amplifies the difference. A change of optics, layout or loads exceeds 1e-3.
const TOLERANCE: f64 = 1e-6;

#[test]
fn the_reference_calibration_is_reproducible() {
    let (fingertip, optics) = of_experiment("cap-closing");
    let separable = text("experiments/reference-fingertip.calibration.toml");
    let committed = Calibration::from_toml(&separable).unwrap();
    let bench = CalibrationBenchConfig::default();
    let made = calibrate_simulated(&fingertip, &optics, &bench).unwrap();

    assert_eq!(committed.made_for, made.made_for);
    assert_eq!(committed.elements.len(), made.elements.len());
    for (element, (a, b)) in committed.elements.iter().zip(&made.elements).enumerate() {
        close(element, a.unloaded_gray, b.unloaded_gray);
        let centroids = a.unloaded_centroid - b.unloaded_centroid;
        assert!(centroids.length() < TOLERANCE * 1e-3, "element {element}");
        let (ForceMap::Separable(a), ForceMap::Separable(b)) = (&a.map, &b.map) else {
            panic!("element {element}: expected the paper's model");
        };
        for (a, b) in [
            (&a.normal, &b.normal),
            (&a.shear_x, &b.shear_x),
            (&a.shear_y, &b.shear_y),
        ] {
            same_curve(element, a, b);
        }
    }
}

/// Compares curves by their forces over their range, relative to the largest.
fn same_curve(element: usize, a: &ForceCurve, b: &ForceCurve) {
    let [low, high] = a.range;
    close(element, low, b.range[0]);
    close(element, high, b.range[1]);
    let largest = a.force(low).abs().max(a.force(high).abs());
    for i in 0..=10 {
        let input = low + (high - low) * f64::from(i) / 10.0;
        let difference = (a.force(input) - b.force(input)).abs();
        assert!(
            difference <= TOLERANCE * largest,
            "element {element} at {input}: {} N differs from {} N",
            a.force(input),
            b.force(input)
        );
    }
}

fn close(element: usize, a: f64, b: f64) {
    assert!(
        (a - b).abs() <= TOLERANCE * a.abs(),
        "element {element}: {a} and {b}"
    );
}
