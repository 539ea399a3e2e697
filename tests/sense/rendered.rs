//! Pictures of the reference fingertip under known loads.

use feeler::config::Experiment;
use feeler::sensor::fingertip::Fingertip;
use feeler::sensor::frame::Picture;
use feeler::sim::optics::{OpticsScratch, render};
use feeler::sim::optics_model::OpticsModel;
use glam::{DVec2, DVec3};
use image::{DynamicImage, GrayImage};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use std::path::Path;

/// The calibration that comes with the reference experiment.
pub const CALIBRATION: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/experiments/reference-fingertip.calibration.toml"
);

/// The fingertip of the reference experiment.
pub fn fingertip() -> Fingertip {
    let experiment = Experiment::load("cap-closing", &[]).expect("the experiment");
    Fingertip::new(&experiment.config.sensor.fingertip).expect("a fingertip")
}

/// A picture and the forces that it was taken under.
pub struct Loaded {
    pub forces: Vec<DVec3>,
    pub picture: Picture,
}

/// So many pictures, the first of them without load. Loads lie in the friction cone that the
/// calibration was made in: up to 2 N, friction up to 0.9.
pub fn pictures(count: usize) -> Vec<Loaded> {
    let experiment = Experiment::load("cap-closing", &[]).expect("the experiment");
    let fingertip = fingertip();
    let optics = &experiment.config.sim.optics;
    let model = OpticsModel::new(optics, &fingertip.layout, &fingertip.projection).expect("optics");
    let mut scratch = OpticsScratch::new(&model);
    let mut rng = Pcg64::seed_from_u64(77);
    let size = (fingertip.projection.width(), fingertip.projection.height());
    let elements = fingertip.layout.elements.len();
    let mut picture_of = |forces: Vec<DVec3>, rng: &mut Pcg64| {
        let mut picture = Picture::black(size.0, size.1);
        render(&model, &mut scratch, &forces, rng, &mut picture).expect("a picture");
        Loaded { forces, picture }
    };
    let mut all = vec![picture_of(vec![DVec3::ZERO; elements], &mut rng)];
    for _ in 1..count {
        let forces = (0..elements).map(|_| load(&mut rng)).collect();
        all.push(picture_of(forces, &mut rng));
    }
    all
}

fn load(rng: &mut Pcg64) -> DVec3 {
    let normal = 2.0 * rng.random::<f64>();
    let shear = 0.9 * normal * rng.random::<f64>();
    (shear * DVec2::from_angle(TAU * rng.random::<f64>())).extend(normal)
}

/// The picture, to be saved in any format.
pub fn image(picture: &Picture) -> DynamicImage {
    let (width, height) = (picture.width as u32, picture.height as u32);
    let gray = GrayImage::from_raw(width, height, picture.pixels.clone()).expect("a picture");
    gray.into()
}

/// Writes the pictures into `folder` as `frame0.png`, `frame1.png`, …
pub fn save(pictures: &[Loaded], folder: &Path) {
    std::fs::create_dir_all(folder).expect("a folder");
    for (index, loaded) in pictures.iter().enumerate() {
        let path = folder.join(format!("frame{index}.png"));
        image(&loaded.picture).save(path).expect("a file");
    }
}

/// The pictures' gray values, one after the other.
pub fn raw(pictures: &[Loaded]) -> Vec<u8> {
    let pixels = pictures.iter().map(|loaded| &loaded.picture.pixels);
    pixels.flatten().copied().collect()
}
