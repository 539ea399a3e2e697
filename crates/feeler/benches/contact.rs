//! Time per frame to estimate a contact.

use divan::{Bencher, black_box};
use feeler::sensor::contact::ContactEstimator;
use feeler::sensor::fingertip::{ElementLayout, GridConfig, LayoutConfig};
use glam::DVec3;

fn main() {
    divan::main();
}

/// A contact that presses a fifth of the dome, while friction is estimated.
fn estimate(bencher: Bencher<'_, '_>, layout: &LayoutConfig) {
    let layout = ElementLayout::new(layout);
    let force = |normal: DVec3| DVec3::new(0.1, 0.0, (2.0 * (normal.x - 0.8)).max(0.0));
    let normals = layout.elements.iter().map(|element| element.normal());
    let forces: Vec<_> = normals.map(force).collect();
    let mut estimator = ContactEstimator::new(layout.places(), 0.01);
    bencher.bench_local(|| estimator.estimate(black_box(&forces)));
}

#[divan::bench]
fn elements_41(bencher: Bencher<'_, '_>) {
    estimate(bencher, &LayoutConfig::default());
}

#[divan::bench]
fn elements_512(bencher: Bencher<'_, '_>) {
    let grid = GridConfig {
        columns: 32,
        rows: 16,
        spacing: 0.001,
    };
    let layout = LayoutConfig {
        rings: Vec::new(),
        grid: Some(grid),
        ..LayoutConfig::default()
    };
    estimate(bencher, &layout);
}
