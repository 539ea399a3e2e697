//! Finds the sensing elements in a picture of the untouched sensor.
//!
//! An element is a bright spot (the white tip of a pin) or a group of spots (the contacts of the
//! conical feelers under one columnar feeler). Neither their number nor their size is given:
//!
//! 1. Bright blobs are the maxima, over place and scale, of the Laplacian of Gaussians (Lindeberg
//!    1998); the size that most of them share is that of the spots (`spots`).
//! 2. If the spots come in groups of one size that lie apart from each other, the groups are the
//!    elements, else the spots are (`groups`).
//! 3. An element's sub-region is the disc about its centre as far as no other centre is nearer.

mod error;
mod groups;
mod reference;
mod regions;
mod scale_space;
mod spots;
mod tree;
mod warning;

pub use error::LocateError;
pub use reference::{MeanPicture, ReferencePicture};
pub use regions::sub_regions;
pub use warning::LocateWarning;

use glam::DVec2;

/// Fewest pixels to a side of a picture that elements are looked for in.
pub const MIN_SIZE: usize = 16;

/// Most spots that are taken for spots and not for texture.
pub const MAX_SPOTS: usize = 4096;

/// What may be said about the elements beforehand; all is found without.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocateConfig {
    /// Diameter of a bright spot, px; the size that most blobs share if absent.
    pub spot_diameter_px: Option<f64>,
    /// Diameter of an element, px: spots that fit into it together are one element. If absent,
    /// spots are grouped only where they lie in groups of one size.
    pub element_diameter_px: Option<f64>,
    /// Radius of a sub-region over the distance to the nearest other element; the sub-region of a
    /// group of spots is large enough for all of them in any case.
    pub region_radius: f64,
}

impl Default for LocateConfig {
    fn default() -> Self {
        Self {
            spot_diameter_px: None,
            element_diameter_px: None,
            // Discs of half the spacing just touch, and a neighbour that moves stays out of them for
            // as long as can be.
            region_radius: 0.5,
        }
    }
}

/// An element as it is seen.
#[derive(Debug, Clone, PartialEq)]
pub struct LocatedElement {
    /// Column and row of its centre, px: the mean of its spots' centres.
    pub centre_px: DVec2,
    /// Radius of its sub-region, px.
    pub radius_px: f64,
    /// Columns and rows of its spots' centres, px.
    pub spots_px: Vec<DVec2>,
}

/// What was found in a reference picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Located {
    /// Columns and rows of the picture, px.
    pub size: (usize, usize),
    /// The elements, in reading order: row by row, as far as there are rows.
    pub elements: Vec<LocatedElement>,
    /// Median distance of an element to its nearest neighbour, px; 0 for a single element.
    pub spacing_px: f64,
    /// Median diameter of a spot, px.
    pub spot_diameter_px: f64,
    /// Spots of an element: 1, or the size of the groups.
    pub spots_per_element: usize,
    /// Grey level a little above the background about the elements, up to which a pixel is dark.
    pub dark_level: u8,
    /// What looks wrong.
    pub warnings: Vec<LocateWarning>,
}

/// Finds the elements in `reference`.
///
/// # Errors
/// When the picture is black, white or without bright spots, or `config` makes no sense.
pub fn locate(reference: &ReferencePicture, config: &LocateConfig) -> Result<Located, LocateError> {
    check(reference, config)?;
    let found = spots::find(reference, config.spot_diameter_px)?;
    let grouped = groups::group(&found.spots, config.element_diameter_px);
    Ok(regions::assemble(reference, config, found, grouped))
}

fn check(reference: &ReferencePicture, config: &LocateConfig) -> Result<(), LocateError> {
    let largest = reference.width.min(reference.height) as f64 / 2.0;
    let ranges = [
        ("spot_diameter_px", config.spot_diameter_px, 1.0, largest),
        (
            "element_diameter_px",
            config.element_diameter_px,
            1.0,
            2.0 * largest,
        ),
        ("region_radius", Some(config.region_radius), 0.1, 2.0),
    ];
    for (name, value, low, high) in ranges {
        if let Some(value) = value.filter(|value| !(low..=high).contains(value)) {
            return Err(LocateError::OutOfRange {
                name,
                low,
                high,
                value,
            });
        }
    }
    let brightest = reference.gray.iter().copied().fold(0.0, f32::max);
    let darkest = reference.gray.iter().copied().fold(255.0, f32::min);
    // A few grey levels are the noise of a picture taken with the cap on, or of one burnt out.
    if brightest < 5.0 {
        return Err(LocateError::Black { brightest });
    }
    if darkest > 250.0 {
        return Err(LocateError::White { darkest });
    }
    Ok(())
}

/// The median; 0 of nothing. Reorders the values.
fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

/// The value below which the part `q` of `values` lies; 0 of nothing. Reorders them.
fn quantile(values: &mut [f64], q: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let index = ((values.len() - 1) as f64 * q).round() as usize;
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}

/// For each point, the indices of its `count` nearest others, the nearest first.
fn nearest(points: &[DVec2], count: usize) -> Vec<Vec<usize>> {
    points
        .iter()
        .enumerate()
        .map(|(own, point)| {
            let distance = |&other: &usize| points[other].distance_squared(*point);
            let mut others: Vec<usize> = (0..points.len()).filter(|&i| i != own).collect();
            let by_distance = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
            if count > 0 && others.len() > count {
                others.select_nth_unstable_by(count - 1, by_distance);
            }
            others.truncate(count);
            others.sort_unstable_by(by_distance);
            others
        })
        .collect()
}
