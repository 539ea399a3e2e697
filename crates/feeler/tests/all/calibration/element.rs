//! An element whose force is a given function of its moments.

use feeler::sensor::calibration::{
    Calibration, CalibrationError, CalibrationTarget, ElementRecord, FullScale, LengthUnit,
    LoadSample, ModelChoice, RelativeMoments, fit,
};
use feeler::sensor::moments::ElementMoments;
use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Integrated gray value (grey levels times px²) and centroid (px) without load.
pub const GRAY: f64 = 3.7e4;
pub const CENTROID: DVec2 = DVec2::new(1.5, -0.25);

/// Least and greatest growth and displacements along x and y (px). The ranges differ in width, and the end with the
/// larger magnitude alternates.
pub const RANGES: [[f64; 2]; 3] = [[-0.05, 0.8], [-3.0, 2.0], [-1.0, 4.0]];

pub fn inputs([growth, x, y]: [f64; 3]) -> RelativeMoments {
    RelativeMoments {
        growth,
        displacement: DVec2::new(x, y),
    }
}

/// Moments of an element with these inputs.
pub fn moments(inputs: RelativeMoments) -> ElementMoments {
    ElementMoments {
        integrated_gray: GRAY * (1.0 + inputs.growth),
        centroid: CENTROID + inputs.displacement,
    }
}

/// Inputs at all corners of `RANGES` and at random places between.
pub fn places(count: usize, seed: u64) -> Vec<RelativeMoments> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let corner = |n: usize| [0, 1, 2].map(|axis: usize| RANGES[axis][(n >> axis) & 1]);
    let corners = (0..8).map(corner);
    let between = (8..count).map(|_| RANGES.map(|[low, high]| rng.random_range(low..high)));
    corners.chain(between).map(inputs).collect()
}

/// Record of an element whose force at each of `inputs` is given by `force`.
pub fn record(
    inputs: &[RelativeMoments],
    force: impl Fn(RelativeMoments) -> DVec3,
) -> ElementRecord {
    let sample = |&inputs: &RelativeMoments| LoadSample {
        force: force(inputs),
        moments: moments(inputs),
    };
    ElementRecord {
        unloaded: vec![moments(RelativeMoments::default())],
        fitted: inputs.iter().map(sample).collect(),
        ..ElementRecord::default()
    }
}

/// Target of a sensor with `elements` elements that differs from others only by its text.
pub fn made_for(elements: usize) -> CalibrationTarget {
    CalibrationTarget::layout("a few elements", elements, LengthUnit::Pixel)
}

pub fn fitted(
    records: &[ElementRecord],
    choice: ModelChoice,
) -> Result<Calibration, CalibrationError> {
    fit(
        made_for(records.len()),
        records,
        choice,
        FullScale::default(),
    )
}
