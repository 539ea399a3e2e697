//! Time of the operations of `feeler sense` on one 640x480 image of 41 elements.

use feeler::sensor::fingertip::Fingertip;
use feeler::sensor::forces::{ElementReading, SensingChain};
use feeler::sensor::image::{DEFAULT_MAX_SATURATED, Picture, SaturationCheck, subregion};
use feeler_lab::config::Experiment;
use feeler_sim::optics::{OpticsModel, OpticsScratch, render};
use feeler_sources::decode_picture;
use glam::DVec3;
use image::{ExtendedColorType, ImageEncoder};
use rand::SeedableRng;
use rand_pcg::Pcg64;

fn main() {
    divan::main();
}

fn experiment() -> Experiment {
    Experiment::load("cap-closing", &[]).expect("the experiment")
}

fn picture() -> Picture {
    let config = experiment().config;
    let tip = Fingertip::new(&config.sensor.fingertip).expect("a fingertip");
    let model = OpticsModel::new(
        &config.simulation().expect("a simulated world").optics,
        &tip.layout,
        &tip.projection,
    )
    .expect("optics");
    let mut picture = Picture::black(tip.projection.width(), tip.projection.height());
    let mut rng = Pcg64::seed_from_u64(1);
    let forces = [DVec3::new(0.1, -0.2, 0.7); 41];
    let mut scratch = OpticsScratch::new(&model);
    render(&model, &mut scratch, &forces, &mut rng, &mut picture).expect("a picture");
    picture
}

/// From the image to all readings, with forces.
#[divan::bench]
fn picture_to_readings(bencher: divan::Bencher) {
    let experiment = experiment();
    let calibration = experiment.calibration(0).expect("its own");
    let sensing =
        SensingChain::of_fingertip(&experiment.config.sensor.fingertip).expect("a sensor");
    let mut sensing = sensing.with_calibration(calibration).expect("its own");
    let mut readings = vec![ElementReading::default(); sensing.element_count()];
    let picture = picture();
    bencher.bench_local(|| sensing.sense(&picture, &mut readings).expect("readings"));
}

/// Only the check for saturated pixels.
#[divan::bench]
fn saturation_of_41_subregions(bencher: divan::Bencher) {
    let config = experiment().config.sensor.fingertip;
    let tip = Fingertip::new(&config).expect("a fingertip");
    let radius = config.moments.subregion_radius;
    let regions: Vec<_> = (0..41)
        .map(|element| subregion(&tip.layout, &tip.projection, element, radius).expect("pixels"))
        .collect();
    let check = SaturationCheck::new(tip.projection.width(), &regions, DEFAULT_MAX_SATURATED);
    let picture = picture();
    bencher.bench_local(|| (0..41).filter(|&e| check.saturated(&picture, e)).count());
}

/// Decoding a PNG file in memory.
#[divan::bench]
fn decode_png(bencher: divan::Bencher) {
    let picture = picture();
    let mut file = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut file);
    let (width, height) = (picture.width as u32, picture.height as u32);
    encoder
        .write_image(&picture.pixels, width, height, ExtendedColorType::L8)
        .expect("a file");
    bencher.bench_local(|| decode_picture(&file).expect("a picture"));
}
