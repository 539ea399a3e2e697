//! Compares images of a simulated fingertip and a real sensor: generates a page with both images and their measured
//! properties.
//!
//! ```text
//! cargo run --release --example compare_optics -p feeler-lab -- PAGE.html EXPERIMENT REAL.png [FORCES.csv] [EXPERIMENT REAL.png ...]
//! ```
//!
//! REAL.png is an image of the untouched sensor. FORCES.csv, in the format of `feeler calibrate --wrench`, contains
//! images under measured forces. Without it, the response of the real image to force is not reported.

#[path = "compare_optics/measure.rs"]
mod measure;
#[path = "compare_optics/page.rs"]
mod page;

use feeler::sensor::fingertip::Fingertip;
use feeler::sensor::image::Picture;
use feeler::sensor::wrench::forces::read_forces;
use feeler_lab::config::Experiment;
use feeler_sim::optics::{OpticsModel, OpticsScratch, render};
use feeler_sources::read_picture;
use glam::DVec3;
use measure::{Loaded, Look};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::error::Error;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Number of images of the simulated fingertip under force.
const PICTURES: usize = 200;
/// Maximum compression of the whole fingertip by a plate (N), and maximum ratio of shear to compression.
const MOST: f64 = 4.0;
const FRICTION: f64 = 0.8;
/// Angle from the apex up to which a plate touches the dome.
const CONTACT_DEG: f64 = 35.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).peekable();
    let output = PathBuf::from(arguments.next().ok_or("PAGE.html expected")?);
    if output.exists() {
        return Err(format!("{} exists already", output.display()).into());
    }
    let mut pairs = Vec::new();
    while let Some(experiment) = arguments.next() {
        let real = PathBuf::from(arguments.next().ok_or("REAL.png expected")?);
        let forces = arguments.next_if(|next| next.ends_with(".csv"));
        let (picture, loaded) = simulated(&experiment)?;
        let simulated = Look::new(picture, &loaded)?;
        let loaded = forces.map_or(Ok(Vec::new()), |csv| measured(Path::new(&csv)))?;
        let real = Look::new(read_picture(&real)?, &loaded)?;
        page::print(&experiment, &simulated, &real);
        pairs.push((experiment, simulated, real));
    }
    std::fs::write(&output, page::page(&pairs)?)?;
    println!("{}", output.display());
    Ok(())
}

/// Renders the untouched fingertip of `experiment`, and the fingertip under a plate.
fn simulated(experiment: &str) -> Result<(Picture, Vec<Loaded>), Box<dyn Error>> {
    let experiment = Experiment::load(experiment, &[])?;
    let config = &experiment.config;
    let (layout, projection) = Fingertip::layout_and_projection(&config.sensor.fingertip)?;
    let model = OpticsModel::new(&config.simulation()?.optics, &layout, &projection)?;
    let mut scratch = OpticsScratch::new(&model);
    let mut rng = Pcg64::seed_from_u64(1);
    let mut take = |force: DVec3| -> Result<Picture, Box<dyn Error>> {
        let touching = |normal: DVec3| (normal.x - CONTACT_DEG.to_radians().cos()).max(0.0);
        let all: f64 = layout.elements.iter().map(|e| touching(e.normal())).sum();
        let forces: Vec<DVec3> = layout
            .elements
            .iter()
            // Each element bears a share of the force, in its own frame, with compression along the inward normal.
            .map(|e| {
                let own = e.rotation.transpose() * force * (touching(e.normal()) / all);
                own.with_z(-own.z)
            })
            .collect();
        let mut picture = Picture::black(projection.width(), projection.height());
        render(&model, &mut scratch, &forces, &mut rng, &mut picture)?;
        Ok(picture)
    };
    let untouched = take(DVec3::ZERO)?;
    let mut forces = Pcg64::seed_from_u64(2);
    let loaded = (0..PICTURES).map(|_| {
        let normal = MOST * forces.random::<f64>();
        let mut shear = || FRICTION * normal * (2.0 * forces.random::<f64>() - 1.0);
        // Force on the fingertip in its frame, where x is the dome's axis.
        let force = DVec3::new(-normal, shear(), shear());
        Ok(Loaded {
            picture: take(force)?,
            force: DVec3::new(force.y, force.z, force.x),
        })
    });
    Ok((untouched, loaded.collect::<Result<_, Box<dyn Error>>>()?))
}

/// Reads the images of a table of measured forces for which all three components were measured.
fn measured(csv: &Path) -> Result<Vec<Loaded>, Box<dyn Error>> {
    let folder = csv.parent().unwrap_or(Path::new(""));
    let pictures = read_forces(File::open(csv)?)?.pictures;
    let forces = pictures.iter().filter_map(|measured| {
        let [x, y, z, ..] = measured.wrench;
        Some((&measured.picture, DVec3::new(x?, y?, z?)))
    });
    let loaded = forces.map(|(picture, force)| {
        Ok(Loaded {
            picture: read_picture(&folder.join(picture))?,
            force,
        })
    });
    loaded.collect()
}
