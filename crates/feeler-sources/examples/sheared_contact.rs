//! Estimates depth, tilt, shear and twist of a contact from images of a sensor whose pins move farther than their
//! spacing. Tracks each pin from one reference image, and fits a ridge regression from the displacements to the pose.
//!
//! ```text
//! cargo run --release --example sheared_contact -- [FOLDER [REFERENCE]]
//! ```
//!
//! FOLDER contains `targets.csv` and `images/`; the default is `$FEELER_DATA/tactip-shear`. REFERENCE is the image of
//! the lightest contact; the default is the first image in `targets.csv`.

#[path = "contact_pose.rs"]
#[allow(dead_code)]
pub mod contact_pose;

pub use contact_pose::DataSet;
use contact_pose::{centred, data_folder_of, fold_error};
use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, ReferencePicture, locate};
use feeler::sensor::track::MarkerTracker;
use feeler_sources::read_picture;
use nalgebra::{DMatrix, DVector};
use std::{error::Error, path::PathBuf};

/// Depth and shear in mm, tilts and twist in degrees.
pub const TARGETS: [&str; 6] = [
    "pose_z", "pose_Rx", "pose_Ry", "shear_x", "shear_y", "shear_Rz",
];

/// Number of cross-validation folds.
const FOLDS: usize = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let folder = arguments
        .next()
        .map_or_else(|| data_folder_of("tactip-shear"), PathBuf::from);
    if !folder.join("targets.csv").exists() {
        println!(
            "SKIPPED: {} does not exist",
            folder.join("targets.csv").display()
        );
        return Ok(());
    }
    let data = DataSet::read(&folder, &TARGETS)?;
    let reference = match arguments.next() {
        Some(path) => read_picture(&PathBuf::from(path))?,
        None => data.pictures[0].clone(),
    };
    let found = sheared_contact(&data, &reference)?;
    let pictures = data.pictures.len();
    let ProjectedPins { pins, lost } = found.seen;
    println!(
        "{pictures} images, {pins} pins, {:.2} % of them lost",
        100.0 * lost
    );
    for ([products, alone], name) in found.errors.iter().zip(TARGETS) {
        println!(
            "{name}: mean absolute error {products:.3} with displacements and their products, {alone:.3} with displacements alone",
        );
    }
    Ok(())
}

/// Statistics of the tracked pins.
#[derive(Debug, Clone, Copy)]
pub struct ProjectedPins {
    pub pins: usize,
    /// Fraction of pins lost, over all images.
    pub lost: f64,
}

/// Result of the example.
pub struct ShearedContact {
    pub seen: ProjectedPins,
    /// Cross-validated mean absolute error for each of [`TARGETS`]: with displacements and their products, and with
    /// displacements alone.
    pub errors: Vec<[f64; 2]>,
}

/// Tracks the pins of `reference` into each image independently, and estimates the poses from their displacements.
pub fn sheared_contact(
    data: &DataSet,
    reference: &Picture,
) -> Result<ShearedContact, Box<dyn Error>> {
    let (seen, displacements) = displacements(&data.pictures, reference)?;
    let pictures = data.pictures.len();
    let x = DMatrix::from_row_slice(pictures, 2 * seen.pins, &displacements);
    let x = centred(&x, &x.row_mean());
    let linear = &x * x.transpose();
    // Includes products of displacements because the response of a contact depends on its current deformation.
    let scale = linear.trace() / pictures as f64;
    let squared = linear.map(|product| (1.0 + product / scale).powi(2));
    let told = |target: usize| {
        let y: DVector<f64> = data.poses.column(target).into();
        [
            least_error(&squared, 1.0, &y),
            least_error(&linear, scale, &y),
        ]
    };
    let errors = (0..data.poses.ncols()).map(told).collect();
    Ok(ShearedContact { seen, errors })
}

/// Displacement of each pin in each image, px: two numbers per pin, one row per image.
fn displacements(
    pictures: &[Picture],
    reference: &Picture,
) -> Result<(ProjectedPins, Vec<f64>), Box<dyn Error>> {
    let located = locate(
        &ReferencePicture::mean([reference])?,
        &LocateConfig::default(),
    )?;
    let mut tracker = MarkerTracker::new(&LocatedLayout::new(&located))?;
    let (mut displacements, mut lost) = (Vec::new(), 0);
    for picture in pictures {
        for marker in tracker.match_picture(picture)? {
            displacements.extend(marker.displacement.to_array());
            lost += usize::from(marker.confidence == 0.0);
        }
    }
    let pins = located.elements.len();
    let lost = lost as f64 / (pictures.len() * pins) as f64;
    Ok((ProjectedPins { pins, lost }, displacements))
}

/// Smallest mean absolute error over ridge parameters up to `largest`.
fn least_error(gram: &DMatrix<f64>, largest: f64, y: &DVector<f64>) -> f64 {
    let ridges = (0..14).map(|exponent| largest * 10_f64.powf(-0.5 * f64::from(exponent)));
    ridges
        .map(|ridge| error(gram, y, ridge))
        .fold(f64::INFINITY, f64::min)
}

/// Mean absolute error over all folds.
fn error(gram: &DMatrix<f64>, y: &DVector<f64>, ridge: f64) -> f64 {
    let folds = (0..FOLDS).map(|fold| fold_error(gram, y, fold, ridge));
    folds.sum::<f64>() / FOLDS as f64
}
