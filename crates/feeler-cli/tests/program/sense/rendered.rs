//! Rendered images of the reference fingertip under known loads.

use feeler::sensor::fingertip::Fingertip;
use feeler::sensor::image::Picture;
use feeler_lab::config::Experiment;
use feeler_sim::optics::{OpticsModel, OpticsScratch, render};
use glam::{DVec2, DVec3};
use image::{DynamicImage, GrayImage};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use std::path::Path;

/// The calibration that is shipped with the reference experiment.
pub const CALIBRATION: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../feeler-lab/experiments/reference-fingertip.calibration.toml"
);

/// The fingertip of the reference experiment.
pub fn fingertip() -> Fingertip {
    let experiment = Experiment::load("cap-closing", &[]).expect("the experiment");
    Fingertip::new(&experiment.config.sensor.fingertip).expect("a fingertip")
}

/// An image and the forces under which it was rendered.
pub struct Loaded {
    pub forces: Vec<DVec3>,
    pub picture: Picture,
}

/// Renders images of the reference fingertip.
struct Renderer {
    model: OpticsModel,
    scratch: OpticsScratch,
    size: (usize, usize),
    rng: Pcg64,
}

impl Renderer {
    fn new() -> Self {
        let experiment = Experiment::load("cap-closing", &[]).expect("the experiment");
        let tip = fingertip();
        let optics = &experiment
            .config
            .simulation()
            .expect("a simulated world")
            .optics;
        let model = OpticsModel::new(optics, &tip.layout, &tip.projection).expect("optics");
        Self {
            scratch: OpticsScratch::new(&model),
            model,
            size: (tip.projection.width(), tip.projection.height()),
            rng: Pcg64::seed_from_u64(77),
        }
    }

    fn picture(&mut self, forces: Vec<DVec3>) -> Loaded {
        let mut picture = Picture::black(self.size.0, self.size.1);
        let (scratch, rng) = (&mut self.scratch, &mut self.rng);
        render(&self.model, scratch, &forces, rng, &mut picture).expect("a picture");
        Loaded { forces, picture }
    }
}

/// Renders `count` images, the first without load. The loads are in the friction cone of the calibration: up to 2 N,
/// friction up to 0.9.
pub fn pictures(count: usize) -> Vec<Loaded> {
    let mut renderer = Renderer::new();
    let elements = fingertip().layout.elements.len();
    let mut all = vec![renderer.picture(vec![DVec3::ZERO; elements])];
    for _ in 1..count {
        let forces = (0..elements).map(|_| load(&mut renderer.rng)).collect();
        all.push(renderer.picture(forces));
    }
    all
}

/// Renders `count` images, all but the first pressed at the apex and the ring around it with up to 2 N per element.
pub fn pressed(count: usize) -> Vec<Loaded> {
    let mut renderer = Renderer::new();
    let elements = fingertip().layout.elements.len();
    let take = |number: usize| {
        let mut forces = vec![DVec3::ZERO; elements];
        if number > 0 {
            forces[..9].fill_with(|| load(&mut renderer.rng));
        }
        renderer.picture(forces)
    };
    (0..count).map(take).collect()
}

/// Renders `count` images, all but the first under 1 N on each of nine elements, while the lamp dims by a tenth.
pub fn dimming(count: usize) -> Vec<Loaded> {
    let mut renderer = Renderer::new();
    let elements = fingertip().layout.elements.len();
    let take = |number: usize| {
        let mut forces = vec![DVec3::ZERO; elements];
        if number > 0 {
            forces[..9].fill(DVec3::Z);
        }
        let mut loaded = renderer.picture(forces);
        let light = 1.0 - 0.1 * number as f64 / (count - 1) as f64;
        for pixel in &mut loaded.picture.pixels {
            *pixel = (f64::from(*pixel) * light).round() as u8;
        }
        loaded
    };
    (0..count).map(take).collect()
}

fn load(rng: &mut Pcg64) -> DVec3 {
    let normal = 2.0 * rng.random::<f64>();
    let shear = 0.9 * normal * rng.random::<f64>();
    (shear * DVec2::from_angle(TAU * rng.random::<f64>())).extend(normal)
}

/// Converts an image to save it in any format.
pub fn image(picture: &Picture) -> DynamicImage {
    let (width, height) = (picture.width as u32, picture.height as u32);
    let gray = GrayImage::from_raw(width, height, picture.pixels.clone()).expect("a picture");
    gray.into()
}

/// Writes the images to `folder` as `frame0.png`, `frame1.png`, …
pub fn save(pictures: &[Loaded], folder: &Path) {
    std::fs::create_dir_all(folder).expect("a folder");
    for (index, loaded) in pictures.iter().enumerate() {
        let path = folder.join(format!("frame{index}.png"));
        image(&loaded.picture).save(path).expect("a file");
    }
}

/// Gray values of all images, one after the other.
pub fn raw(pictures: &[Loaded]) -> Vec<u8> {
    let pixels = pictures.iter().map(|loaded| &loaded.picture.pixels);
    pixels.flatten().copied().collect()
}
