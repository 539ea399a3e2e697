//! Time per frame to convert the moments of 41 elements to forces.

use divan::{Bencher, black_box};
use feeler::sensor::calibration::{Calibration, ModelChoice};
use feeler::sensor::fingertip::FingertipConfig;
use feeler::sensor::forces::{DriftConfig, DriftCorrection};
use feeler::sensor::moments::ElementMoments;
use feeler_sim::bench::{CalibrationBenchConfig, calibrate_simulated};
use feeler_sim::optics::OpticsConfig;
use glam::{DVec2, DVec3};

fn main() {
    divan::main();
}

fn calibration(model: ModelChoice) -> Calibration {
    let bench = CalibrationBenchConfig {
        model,
        ..CalibrationBenchConfig::default()
    };
    let (fingertip, optics) = (FingertipConfig::default(), OpticsConfig::default());
    calibrate_simulated(&fingertip, &optics, &bench).expect("the default fingertip")
}

/// Moments of elements that are all loaded.
fn moments(calibration: &Calibration) -> Vec<ElementMoments> {
    let elements = calibration.elements.iter();
    elements
        .map(|element| ElementMoments {
            integrated_gray: 3.0 * element.unloaded_gray,
            centroid: element.unloaded_centroid + DVec2::new(1e-4, -2e-4),
        })
        .collect()
}

#[divan::bench(args = ["separable", "coupled"])]
fn forces(bencher: Bencher, model: &str) {
    let calibration = calibration(match model {
        "coupled" => ModelChoice::Coupled,
        _ => ModelChoice::Separable,
    });
    let moments = moments(&calibration);
    let mut forces = vec![DVec3::ZERO; moments.len()];
    bencher.bench_local(|| calibration.forces(black_box(&moments), black_box(&mut forces)));
}

#[divan::bench]
fn drift_correction(bencher: Bencher) {
    let calibration = calibration(ModelChoice::Separable);
    let mut drift = DriftCorrection::new(DriftConfig::default(), &calibration);
    let unchanged = moments(&calibration);
    let mut moments = unchanged.clone();
    bencher.bench_local(|| {
        moments.copy_from_slice(&unchanged);
        drift.correct(black_box(&mut moments));
    });
}
