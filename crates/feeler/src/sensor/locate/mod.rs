//! Locates the sensing elements in an image of the unloaded sensor.
//!
//! An element is a single spot, bright on dark (the tip of a pin) or dark on bright (a marker on a gel), or a group
//! of spots (the contacts of the conical feelers under one columnar feeler). Neither the number nor the size of the
//! elements must be known:
//!
//! 1. Bright or dark blobs are maxima of the Laplacian of Gaussians over position and scale (Lindeberg 1998). The most
//!    common blob size is the size of the spots (`spots`).
//! 2. If the spots form separate groups of a single size, each group is an element, otherwise each spot (`groups`).
//! 3. Spots that are too few, or too irregular in spacing, size and contrast, are rejected: they are not markers
//!    (`pattern`).
//! 4. An element's sub-region is the disc around its centre, without the pixels that are closer to another centre.

mod centroid;
mod crowding;
mod error;
mod ground;
mod groups;
mod outline;
mod pattern;
mod quick;
mod reference;
mod regions;
mod scale_space;
mod spot;
mod spots;
mod strays;
mod tree;
mod warning;

pub use crate::sensor::image::polarity::Polarity;
pub use error::LocateError;
pub use pattern::PatternDefect;
pub(super) use quick::blobs_of_size;
pub use reference::{MeanPicture, ReferencePicture};
pub use regions::sub_regions;
pub use warning::LocateWarning;

use self::{pattern::Assessment, scale_space::ScaleSpace, spot::FoundSpots, spots::Search};
use crate::sensor::image::cells::Cells;
use glam::DVec2;
use std::borrow::Cow;

/// Minimum width and height of an image, px.
pub const MIN_SIZE: usize = 16;

/// Maximum number of spots; an image with more spots contains texture.
pub const MAX_SPOTS: usize = 4096;

/// Optional prior knowledge of the elements; missing values are estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocateConfig {
    /// Polarity of the elements, or `None` to choose the polarity with the better pattern.
    pub polarity: Option<Polarity>,
    /// Diameter of a spot, px; if `None`, the most common blob size.
    pub spot_diameter_px: Option<f64>,
    /// Diameter of an element, px: spots that fit within it form one element. If `None`, spots are grouped only if they
    /// form groups of a single size.
    pub element_diameter_px: Option<f64>,
    /// Radius of a sub-region relative to the distance to the nearest other element. The sub-region of a group of spots
    /// is enlarged if necessary to contain all of them.
    pub region_radius: f64,
}

impl Default for LocateConfig {
    fn default() -> Self {
        Self {
            polarity: None,
            spot_diameter_px: None,
            element_diameter_px: None,
            // Discs of half the spacing just touch, which leaves neighbours the most room to move without overlap.
            region_radius: 0.5,
        }
    }
}

/// An element located in an image.
#[derive(Debug, Clone, PartialEq)]
pub struct LocatedElement {
    /// Column and row of the centre, px: the mean of the spots' centres.
    pub centre_px: DVec2,
    /// Radius of the sub-region, px.
    pub radius_px: f64,
    /// Columns and rows of the spots' centres, px.
    pub spots_px: Vec<DVec2>,
    /// Background gray level. Pixels at or below it do not belong to the element (dark elements: at or above it).
    pub ground_level: u8,
}

/// Elements located in a reference image.
#[derive(Debug, Clone, PartialEq)]
pub struct Located {
    /// Polarity of the elements.
    pub polarity: Polarity,
    /// Columns and rows of the image, px.
    pub size: (usize, usize),
    /// Elements in reading order, row by row if they lie in rows.
    pub elements: Vec<LocatedElement>,
    /// Median distance between an element and its nearest neighbour, px; 0 for a single element.
    pub spacing_px: f64,
    /// Median diameter of the spots derived from the blob scale, px.
    pub spot_diameter_px: f64,
    /// Median diameter of the discs with the same areas as the spots, px.
    pub spot_area_diameter_px: f64,
    /// Number of spots per element: 1, or the typical number in a group.
    pub spots_per_element: usize,
    /// Common background gray level of all elements, for even lighting: slightly above the background of bright
    /// elements, slightly below that of dark ones.
    pub dark_level: u8,
    /// `true` if every pixel is black or white.
    pub two_level: bool,
    /// Possible problems.
    pub warnings: Vec<LocateWarning>,
}

/// Minimum diameter of a spot after binning, px, if its size is known.
const MIN_DIAMETER: f64 = 5.0;

/// Locates the elements in `reference`.
///
/// # Errors
/// If the image is black, white or contains no spots, if the spots are not a pattern of markers, or if a value of
/// `config` is out of range.
pub fn locate(reference: &ReferencePicture, config: &LocateConfig) -> Result<Located, LocateError> {
    check(reference, config)?;
    located(reference, config, find(reference, config)?)
}

/// Locates the elements in another image of the sensor, given an earlier result `before`. Searches only for spots of
/// the same polarity and similar size, in less than half the time of [`locate`].
///
/// # Errors
/// See [`locate`].
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
    let factor = (before.spot_diameter_px / MIN_DIAMETER) as usize;
    let factor = factor.max(binning(reference));
    located(reference, config, find_binned(reference, &known, factor)?)
}

/// Creates the elements from the spots found.
fn located(
    reference: &ReferencePicture,
    config: &LocateConfig,
    (polarity, found): (Polarity, FoundSpots),
) -> Result<Located, LocateError> {
    // A given spot diameter means that the user has identified the spots.
    let identified = config.spot_diameter_px.is_some();
    let defects = match pattern::assess(&found.spots, found.noise) {
        Assessment::NoPattern(defects) if !identified => {
            return Err(LocateError::NoPattern {
                polarity,
                spots: found.spots.len(),
                defects,
            });
        }
        Assessment::NoPattern(defects) | Assessment::Pattern(defects) => defects,
    };
    let grouped = groups::group(&found.spots, config.element_diameter_px);
    let oriented = reference.oriented(polarity);
    let mut located = regions::assemble(&oriented, polarity, config, found, grouped);
    if !defects.is_empty() {
        located
            .warnings
            .push(LocateWarning::IrregularPattern { defects });
    }
    Ok(located)
}

/// Maximum number of pixels searched at full resolution; larger images are binned.
const MAX_PIXELS: usize = 3_000_000;

/// Finds the spots with the configured polarity or, if not configured, with the polarity whose pattern scores higher.
fn find(
    reference: &ReferencePicture,
    config: &LocateConfig,
) -> Result<(Polarity, FoundSpots), LocateError> {
    let factor = binning(reference);
    let found = find_binned(reference, config, factor);
    match found {
        // The spots may be grain, which stronger binning removes.
        Err(LocateError::TooManySpots { .. }) if factor > 1 => {
            find_binned(reference, config, 2 * factor)
        }
        found => found,
    }
}

/// Binning factor: 1 unless the image has more than [`MAX_PIXELS`].
fn binning(reference: &ReferencePicture) -> usize {
    let pixels = reference.width * reference.height;
    ((pixels as f64 / MAX_PIXELS as f64).sqrt().ceil() as usize).max(1)
}

/// Finds the spots in the image binned by `factor`.
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
    // Inverting the image does not change its noise.
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
    // Noise alone reaches a few gray levels in an image taken with a covered lens or in a saturated one.
    if brightest < 5.0 {
        return Err(LocateError::Black { brightest });
    }
    if darkest > 250.0 {
        return Err(LocateError::White { darkest });
    }
    Ok(())
}

/// Returns the median of `values`, or 0 if empty. Reorders `values`.
pub(super) fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

/// Returns the median of `value` over the spots `near`, or 0 if `near` is empty.
fn median_of(near: &[usize], value: impl Fn(usize) -> f64) -> f64 {
    let mut values: Vec<f64> = near.iter().map(|&spot| value(spot)).collect();
    median(&mut values)
}

/// Returns the `q` quantile of `values`, or 0 if empty. Reorders `values`.
fn quantile(values: &mut [f64], q: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let index = ((values.len() - 1) as f64 * q).round() as usize;
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}

/// For each point, the indices of its `count` nearest neighbours, nearest first.
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
