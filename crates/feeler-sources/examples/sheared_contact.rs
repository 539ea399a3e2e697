//! Tells depth, tilt, shear and twist of a contact from pictures of a sensor whose pins move farther than their spacing: follows each
//! pin by identity from one reference picture, and fits a ridge regression from the displacements to the pose.
//!
//! ```text
//! cargo run --release --example sheared_contact -- [FOLDER [REFERENCE]]
//! ```
//!
//! FOLDER holds `targets.csv` and `images/`; without it, `$FEELER_DATA/tactip-shear`. REFERENCE is the picture of the lightest contact, by
//! default the first that `targets.csv` names.

#[path = "contact_pose.rs"]
#[allow(dead_code)]
pub mod contact_pose;

pub use contact_pose::DataSet;
use contact_pose::{centred, data_folder_of, fold_error};
use feeler::sensor::frame::Picture;
use feeler::sensor::locate::{LocateConfig, ReferencePicture, locate};
use feeler::sensor::located_layout::LocatedLayout;
use feeler::sensor::track::MarkerTracker;
use feeler_sources::picture::read_picture;
use nalgebra::{DMatrix, DVector};
use std::{error::Error, path::PathBuf};

/// Depth and shear in mm, tilts and twist in degrees.
pub const TARGETS: [&str; 6] = [
    "pose_z", "pose_Rx", "pose_Ry", "shear_x", "shear_y", "shear_Rz",
];

/// Parts of which each is predicted by a fit to the others.
const FOLDS: usize = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let folder = arguments
        .next()
        .map_or_else(|| data_folder_of("tactip-shear"), PathBuf::from);
    if !folder.join("targets.csv").exists() {
        println!(
            "SKIPPED: there is no {}",
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
    let SeenPins { pins, lost } = found.seen;
    println!(
        "{pictures} pictures, {pins} pins, {:.2} % of them lost",
        100.0 * lost
    );
    for ([products, alone], name) in found.errors.iter().zip(TARGETS) {
        println!(
            "{name}: mean absolute error {products:.3} by a ridge of the displacements and their products, {alone:.3} by one of the displacements alone",
        );
    }
    Ok(())
}

/// How the pins were seen.
#[derive(Debug, Clone, Copy)]
pub struct SeenPins {
    pub pins: usize,
    /// Part of them that was lost, over all pictures.
    pub lost: f64,
}

/// What came of it.
pub struct ShearedContact {
    pub seen: SeenPins,
    /// For each of [`TARGETS`], the mean absolute error on parts that were not fitted: by a ridge of the displacements and their products,
    /// and by one of the displacements alone.
    pub errors: Vec<[f64; 2]>,
}

/// Follows the pins of `reference` into each picture by itself, and tells the poses from where they went.
pub fn sheared_contact(
    data: &DataSet,
    reference: &Picture,
) -> Result<ShearedContact, Box<dyn Error>> {
    let (seen, displacements) = displacements(&data.pictures, reference)?;
    let pictures = data.pictures.len();
    let x = DMatrix::from_row_slice(pictures, 2 * seen.pins, &displacements);
    let x = centred(&x, &x.row_mean());
    let linear = &x * x.transpose();
    // The products of all displacements, too: what a contact does depends on what it did already.
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

/// Where each pin went in each picture, px: two numbers for a pin, a row for a picture.
fn displacements(
    pictures: &[Picture],
    reference: &Picture,
) -> Result<(SeenPins, Vec<f64>), Box<dyn Error>> {
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
    Ok((SeenPins { pins, lost }, displacements))
}

/// The least mean absolute error of any ridge up to `largest`.
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
