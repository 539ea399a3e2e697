//! Median time from an image to moments and to forces over many frames, on one core.
//!
//! `cargo run --release --example moments_speed [-- FOLDER]` also writes the input of
//! `benches/peers/opencv.py` to FOLDER, so that it does the same work: the image, the table that dewarps the squares
//! and the position of each square in it.

#[path = "../benches/support/mod.rs"]
mod support;

use feeler::sensor::calibration::Calibration;
use feeler::sensor::fingertip::{DomeProjection, Fingertip, FingertipConfig};
use feeler::sensor::image::Picture;
use feeler::sensor::moments::{ElementMoments, Instructions, MomentsKernel};
use glam::{DVec2, DVec3};
use std::{error::Error, fs, hint::black_box, path::Path, time::Instant};
use support::{fingertip_config, simulated_picture, square_kernel};

/// Number of frames.
const FRAMES: usize = 20_001;

/// Side of the squares in an image of 640x480 (px).
const SIDE: usize = 60;

fn main() -> Result<(), Box<dyn Error>> {
    let calibration = Calibration::from_toml(&fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("experiments/reference-fingertip.calibration.toml"),
    )?)?;
    for scale in [1, 2] {
        let config = fingertip_config(scale);
        let fingertip = Fingertip::new(&config)?;
        let picture = simulated_picture(&config, &fingertip);
        let squares = square_kernel(&config, &fingertip, SIDE * scale);
        for instructions in Instructions::available() {
            for (what, kernel) in [("own", &fingertip.kernel), ("squares", &squares)] {
                let kernel = kernel.clone().with_instructions(instructions);
                println!(
                    "{}x{} {what:8} {:10} moments {:7.2} us, forces {:7.2} us",
                    picture.width,
                    picture.height,
                    format!("{instructions:?}"),
                    median(&kernel, &picture, None)?,
                    median(&kernel, &picture, Some(&calibration))?,
                );
            }
        }
        if let (1, Some(folder)) = (scale, std::env::args().nth(1)) {
            write_for_peers(Path::new(&folder), &config, &fingertip, &picture)?;
        }
    }
    Ok(())
}

/// Median time from `picture` to moments, or to forces if there is a calibration (us).
fn median(
    kernel: &MomentsKernel,
    picture: &Picture,
    calibration: Option<&Calibration>,
) -> Result<f64, Box<dyn Error>> {
    let mut moments = vec![ElementMoments::default(); kernel.element_count()];
    let mut forces = vec![DVec3::ZERO; kernel.element_count()];
    let mut times = Vec::with_capacity(FRAMES);
    for _ in 0..FRAMES {
        let start = Instant::now();
        kernel.measure(black_box(picture), black_box(&mut moments))?;
        if let Some(calibration) = calibration {
            calibration.forces(&moments, black_box(&mut forces));
        }
        times.push(start.elapsed().as_secs_f64() * 1e6);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[FRAMES / 2])
}

/// Writes `picture.pgm` and `remap.f32`. The latter contains, for each pixel of an image of the same size with
/// the dewarped squares side by side, the source column and row in the original image.
fn write_for_peers(
    folder: &Path,
    config: &FingertipConfig,
    fingertip: &Fingertip,
    picture: &Picture,
) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    let mut pgm = format!("P5\n{} {}\n255\n", picture.width, picture.height).into_bytes();
    pgm.extend(&picture.pixels);
    fs::write(folder.join("picture.pgm"), pgm)?;
    let across = picture.width / SIDE;
    let mut remap = Vec::with_capacity(picture.pixels.len() * 8);
    for row in 0..picture.height {
        for column in 0..picture.width {
            let place = DVec2::new((column % SIDE) as f64, (row % SIDE) as f64);
            let in_square = column < across * SIDE;
            let element = row / SIDE * across + column / SIDE;
            let seen = (in_square && element < fingertip.layout.elements.len())
                .then(|| seen_at(&fingertip.projection, fingertip, element, place, config))
                .flatten();
            let seen = seen.unwrap_or(DVec2::new(column as f64, row as f64));
            for value in [seen.x, seen.y] {
                remap.extend((value as f32).to_le_bytes());
            }
        }
    }
    fs::write(folder.join("remap.f32"), remap)?;
    Ok(())
}

/// Image position of a point of an element's square, which circumscribes the element's sub-region.
fn seen_at(
    projection: &DomeProjection,
    fingertip: &Fingertip,
    element: usize,
    place: DVec2,
    config: &FingertipConfig,
) -> Option<DVec2> {
    let half = (SIDE - 1) as f64 / 2.0;
    let plane = (place - half) / half * config.moments.subregion_radius;
    projection.project(projection.lift(plane, &fingertip.layout.elements[element])?)
}
