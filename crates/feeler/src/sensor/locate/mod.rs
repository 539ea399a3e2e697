//! Finds the sensing elements in a picture of the untouched sensor.
//!
//! An element is a spot, bright on dark (the white tip of a pin) or dark on bright (a marker on a gel), or a group of spots (the contacts of the
//! conical feelers under one columnar feeler). Neither their number nor their size is given:
//!
//! 1. Blobs, bright or dark, are the maxima, over place and scale, of the Laplacian of Gaussians (Lindeberg
//!    1998); the size that most of them share is that of the spots (`spots`).
//! 2. If the spots come in groups of one size that lie apart from each other, the groups are the
//!    elements, else the spots are (`groups`).
//! 3. Spots that are not evenly spaced, of similar size and of similar contrast are no markers (`pattern`).
//! 4. An element's sub-region is the disc about its centre as far as no other centre is nearer.

mod centroid;
mod error;
mod ground;
mod groups;
mod outline;
mod pattern;
mod quick;
mod reference;
mod regions;
mod scale_space;
mod spots;
mod strays;
mod tree;
mod warning;

pub use super::polarity::Polarity;
pub use error::LocateError;
pub use pattern::Unlike;
pub(super) use quick::blobs_of_size;
pub use reference::{MeanPicture, ReferencePicture};
pub use regions::sub_regions;
pub use warning::LocateWarning;

use self::{
    scale_space::ScaleSpace,
    spots::{FoundSpots, Search},
};
use super::cells::Cells;
use glam::DVec2;
use std::borrow::Cow;

/// Fewest pixels to a side of a picture that elements are looked for in.
pub const MIN_SIZE: usize = 16;

/// Most spots that are taken for spots and not for texture.
pub const MAX_SPOTS: usize = 4096;

/// What may be said about the elements beforehand; all is found without.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocateConfig {
    /// Whether elements are bright or dark; whichever makes the better pattern if absent.
    pub polarity: Option<Polarity>,
    /// Diameter of a spot, px; the size that most blobs share if absent.
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
            polarity: None,
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
    /// Grey level of the ground about it: up to it (of dark elements: from it on) a pixel is none of the element.
    pub ground_level: u8,
}

/// What was found in a reference picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Located {
    /// Whether the elements are bright or dark.
    pub polarity: Polarity,
    /// Columns and rows of the picture, px.
    pub size: (usize, usize),
    /// The elements, in reading order: row by row, as far as there are rows.
    pub elements: Vec<LocatedElement>,
    /// Median distance of an element to its nearest neighbour, px; 0 for a single element.
    pub spacing_px: f64,
    /// Median diameter of the disc that is most blob-like where a spot is, px.
    pub spot_diameter_px: f64,
    /// Median diameter of the disc that has a spot's area at its contrast, px.
    pub spot_area_diameter_px: f64,
    /// Spots of an element: 1, or the size of the groups.
    pub spots_per_element: usize,
    /// The same for all elements where light is even: a little above the background about them, up to which a pixel is dark. Of dark
    /// elements, a little below it, from which on a pixel is bright.
    pub dark_level: u8,
    /// Whether every pixel is black or white.
    pub two_level: bool,
    /// What looks wrong.
    pub warnings: Vec<LocateWarning>,
}

/// Diameter that spots of known size keep, at least, in the means of several pixels that are searched for them, px.
const LEAST_DIAMETER: f64 = 5.0;

/// Finds the elements in `reference`.
///
/// # Errors
/// When the picture is black, white or without bright spots, or `config` makes no sense.
pub fn locate(reference: &ReferencePicture, config: &LocateConfig) -> Result<Located, LocateError> {
    check(reference, config)?;
    located(reference, config, find(reference, config)?)
}

/// Finds the elements in another picture of the sensor on which `before` was found. Only spots of that polarity and of about that size are
/// searched, in less than half of the time.
///
/// # Errors
/// As [`locate`].
pub fn locate_again(
    reference: &ReferencePicture,
    config: &LocateConfig,
    before: &Located,
) -> Result<Located, LocateError> {
    check(reference, config)?;
    let known = LocateConfig {
        polarity: Some(before.polarity),
        spot_diameter_px: Some(before.spot_diameter_px),
        ..*config
    };
    let factor = (before.spot_diameter_px / LEAST_DIAMETER) as usize;
    let factor = factor.max(binning(reference));
    located(reference, config, find_binned(reference, &known, factor)?)
}

/// The elements that the spots found make.
fn located(
    reference: &ReferencePicture,
    config: &LocateConfig,
    (polarity, found): (Polarity, FoundSpots),
) -> Result<Located, LocateError> {
    let unlike = pattern::unlike_markers(&found.spots, found.noise);
    // Whoever says how large spots are has seen some.
    if unlike.len() >= 2 && config.spot_diameter_px.is_none() {
        return Err(LocateError::NoPattern {
            polarity,
            spots: found.spots.len(),
            unlike,
        });
    }
    let grouped = groups::group(&found.spots, config.element_diameter_px);
    let oriented = reference.oriented(polarity);
    let mut located = regions::assemble(&oriented, polarity, config, found, grouped);
    if !unlike.is_empty() {
        located.warnings.push(LocateWarning::Unlike { unlike });
    }
    Ok(located)
}

/// Most pixels that are searched for spots one by one; of a larger picture the means of several are.
const MOST_PIXELS: usize = 3_000_000;

/// The spots of the polarity that makes the better pattern, unless one is given.
fn find(
    reference: &ReferencePicture,
    config: &LocateConfig,
) -> Result<(Polarity, FoundSpots), LocateError> {
    let factor = binning(reference);
    let found = find_binned(reference, config, factor);
    match found {
        // What is found may be grain, which coarser means do not show.
        Err(LocateError::TooManySpots { .. }) if factor > 1 => {
            find_binned(reference, config, 2 * factor)
        }
        found => found,
    }
}

/// Pixels to a side of the squares whose means are searched for spots: 1 unless the picture has more than [`MOST_PIXELS`].
fn binning(reference: &ReferencePicture) -> usize {
    let pixels = reference.width * reference.height;
    ((pixels as f64 / MOST_PIXELS as f64).sqrt().ceil() as usize).max(1)
}

/// Finds the spots in the means of `factor` by `factor` pixels.
fn find_binned(
    reference: &ReferencePicture,
    config: &LocateConfig,
    factor: usize,
) -> Result<(Polarity, FoundSpots), LocateError> {
    let binned = match factor {
        1 => Cow::Borrowed(reference),
        factor => Cow::Owned(reference.binned(factor)),
    };
    let diameter = config
        .spot_diameter_px
        .map(|diameter| diameter / factor as f64);
    let coarsest = spots::coarsest((binned.width, binned.height), diameter);
    let mut space = ScaleSpace::new(&binned, coarsest);
    // Of an inverted picture it is the same.
    let noise = [reference.noise(), binned.noise()];
    let mut best: Option<(f64, Polarity, FoundSpots)> = None;
    let mut refused = None;
    for polarity in [Polarity::Bright, Polarity::Dark] {
        if config.polarity.is_some_and(|given| given != polarity) {
            continue;
        }
        if polarity == Polarity::Dark {
            space = space.negated();
        }
        let found = spots::find(&Search {
            picture: &reference.oriented(polarity),
            binned: &binned.oriented(polarity),
            factor,
            space: &space,
            noise,
            diameter: config.spot_diameter_px,
        });
        match found {
            Ok(found) => {
                let score = pattern::score(&found.spots);
                if best.as_ref().is_none_or(|best| score > best.0) {
                    best = Some((score, polarity, found));
                }
            }
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    match (best, refused) {
        (Some((_, polarity, found)), _) => Ok((polarity, found)),
        (None, Some(error)) => Err(error),
        (None, None) => Err(LocateError::NoPicture),
    }
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
pub(super) fn median(values: &mut [f64]) -> f64 {
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
pub(super) fn nearest(points: &[DVec2], count: usize) -> Vec<Vec<usize>> {
    let cells = Cells::new(points);
    let mut near = Vec::new();
    let others = |(own, point): (usize, &DVec2)| {
        cells.nearest(*point, count + 1, &mut near);
        let others = near.iter().map(|&(_, other)| other);
        others.filter(|&other| other != own).take(count).collect()
    };
    points.iter().enumerate().map(others).collect()
}
