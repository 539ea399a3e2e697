//! Checks whether an image is plausibly of a fingertip, loaded or not.

use crate::sensor::calibration::element::ForceValidity;
use crate::sensor::calibration::model::Calibration;
use crate::sensor::image::frame::Picture;
use crate::sensor::image::subregion::WeightedPixel;
use crate::sensor::moments::kernel::ElementMoments;
use std::fmt;

/// Minimum fraction of elements whose moments are within the calibration's range. In images of a fingertip, pressed or
/// not, this is nearly 1; in other images, elements are within the range only by chance.
const MIN_ALIKE: f64 = 0.8;

/// Maximum mean brightness between the sub-regions relative to that within them. It is about 0 for a fingertip and 1
/// for a uniform image.
const MAX_BETWEEN: f64 = 0.25;

/// Similarity of an image to the images of a fingertip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Likeness {
    /// Number of elements whose moments are within the range of the calibration's loads.
    pub alike: usize,
    /// Number of all elements.
    pub elements: usize,
    /// Mean gray level above the background between the sub-regions, relative to the mean within them.
    pub between: f64,
}

impl Likeness {
    /// Compares `picture` and its `moments` with the fingertip of `calibration`. `regions` are the pixels of its
    /// elements, `dark_level` is the gray level of the background.
    pub fn of(
        picture: &Picture,
        moments: &[ElementMoments],
        calibration: &Calibration,
        regions: &[Vec<WeightedPixel>],
        dark_level: u8,
    ) -> Self {
        let elements = calibration.elements.iter().zip(moments);
        let alike = elements
            .filter(|(element, moments)| element.validity(moments) == ForceValidity::Calibrated);
        Self {
            alike: alike.count(),
            elements: calibration.elements.len(),
            between: light_between(picture, regions, dark_level),
        }
    }

    /// Returns whether the image is similar enough to be of the fingertip.
    pub fn is_enough(&self) -> bool {
        self.alike as f64 >= MIN_ALIKE * self.elements as f64 && self.between <= MAX_BETWEEN
    }
}

impl fmt::Display for Likeness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            alike,
            elements,
            between,
        } = self;
        write!(
            f,
            "{alike} of {elements} elements have a plausible position and brightness (expected at least {:.0}), and the brightness between them is {between:.2} \
             times that of the elements (expected at most {MAX_BETWEEN})",
            (MIN_ALIKE * *elements as f64).ceil()
        )
    }
}

/// Mean gray level above `dark_level` of the pixels between the regions, within their common bounding box, relative
/// to the mean within the regions. Infinite if the regions are dark.
fn light_between(picture: &Picture, regions: &[Vec<WeightedPixel>], dark_level: u8) -> f64 {
    let mut within = vec![false; picture.pixels.len()];
    let (mut columns, mut rows) = ((usize::MAX, 0), (usize::MAX, 0));
    for pixel in regions.iter().flatten() {
        if let Some(within) = within.get_mut(pixel.row * picture.width + pixel.column) {
            *within = true;
        }
        columns = (columns.0.min(pixel.column), columns.1.max(pixel.column));
        rows = (rows.0.min(pixel.row), rows.1.max(pixel.row));
    }
    // Sum and number of pixels, between and within.
    let mut light = [(0.0, 0.0); 2];
    for (place, (&gray, &within)) in picture.pixels.iter().zip(&within).enumerate() {
        let (column, row) = (place % picture.width, place / picture.width);
        if (columns.0..=columns.1).contains(&column) && (rows.0..=rows.1).contains(&row) {
            let (sum, count) = &mut light[usize::from(within)];
            *sum += f64::from(gray.saturating_sub(dark_level));
            *count += 1.0;
        }
    }
    let [between, within] = light.map(|(sum, count)| sum / f64::max(count, 1.0));
    match within > 0.0 {
        true => between / within,
        false => f64::INFINITY,
    }
}
