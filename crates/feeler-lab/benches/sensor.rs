//! Time per frame of a sensor: rendering of its image in the simulation, and evaluation of the image.

#[allow(dead_code, reason = "the examples use the rest")]
mod support;

use divan::{Bencher, black_box};
use feeler::sensor::calibration::Calibration;
use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
use feeler::sensor::forces::{ElementReading, SensingChain};
use feeler::sensor::image::{DEFAULT_MAX_SATURATED, Picture};
use feeler::sensor::moments::Instructions;
use feeler_sim::optics::{OpticsConfig, OpticsModel, OpticsScratch, render};
use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use support::{fingertip_config, simulated_picture};

fn main() {
    divan::main();
}

fn model(fingertip: &Fingertip) -> OpticsModel {
    OpticsModel::new(
        &OpticsConfig::default(),
        &fingertip.layout,
        &fingertip.projection,
    )
    .expect("the default optics fit the default fingertip")
}

fn fingertip() -> Fingertip {
    Fingertip::new(&FingertipConfig::default()).expect("the default fingertip makes sense")
}

/// Forces with 1 N and a little shear on `loaded` elements.
fn forces(loaded: usize) -> Vec<DVec3> {
    let mut forces = vec![DVec3::ZERO; 41];
    forces[..loaded].fill(DVec3::new(0.3, -0.2, 1.0));
    forces
}

/// All available instruction sets, for images of 640x480 pixels and of twice that resolution.
fn paths() -> Vec<(Instructions, usize)> {
    let scales = |instructions| [1, 2].map(|scale| (instructions, scale));
    Instructions::available().flat_map(scales).collect()
}

/// From the image to forces, including the saturation check.
#[divan::bench(args = paths())]
fn picture_to_forces(bencher: Bencher, (instructions, scale): (Instructions, usize)) {
    let config = fingertip_config(scale);
    let fingertip = Fingertip::new(&config).expect("the fingertip makes sense");
    let picture = simulated_picture(&config, &fingertip);
    let size = (picture.width, picture.height);
    let (kernel, regions) = Fingertip::kernel_and_subregions(&config).expect("it does");
    let kernel = kernel.with_instructions(instructions);
    let calibration = Calibration::from_toml(include_str!(
        "../experiments/reference-fingertip.calibration.toml"
    ));
    let mut sensing = SensingChain::new(size, kernel, &regions, DEFAULT_MAX_SATURATED)
        .and_then(|sensing| sensing.with_calibration(calibration?))
        .expect("all are for 41 elements");
    let mut readings = vec![ElementReading::default(); sensing.element_count()];
    bencher.bench_local(|| sensing.sense(black_box(&picture), black_box(&mut readings)));
}

#[divan::bench(args = [0, 5, 41])]
fn picture_with_loaded_elements(bencher: Bencher, loaded: usize) {
    draw(bencher, &model(&fingertip()), loaded);
}

/// Only the sensed pixels of the same image, as in a run whose images are not recorded.
#[divan::bench(args = [0, 5, 41])]
fn sensed_pixels_with_loaded_elements(bencher: Bencher, loaded: usize) {
    let fingertip = fingertip();
    let model = model(&fingertip).drawing_only(fingertip.kernel.pixels());
    draw(bencher, &model, loaded);
}

fn draw(bencher: Bencher, model: &OpticsModel, loaded: usize) {
    let mut scratch = OpticsScratch::new(model);
    let mut picture = Picture::black(640, 480);
    let mut rng = Pcg64::seed_from_u64(1);
    let forces = forces(loaded);
    bencher.bench_local(|| {
        render(
            model,
            &mut scratch,
            black_box(&forces),
            &mut rng,
            black_box(&mut picture),
        )
    });
}
