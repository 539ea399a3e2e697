//! Whether a picture may be of a fingertip at all, whatever presses on it.

use super::calibration::{Calibration, ForceValidity};
use super::frame::Picture;
use super::moments::ElementMoments;
use super::subregion::WeightedPixel;
use std::fmt;

/// Part of the elements that must be as the calibration has seen them, at rest or pressed. Of pressed and unpressed fingertips
/// nearly all are; of other pictures, an element is by chance.
const LEAST_ALIKE: f64 = 0.8;

/// Most light between the sub-regions, as a part of that within them, pixel for pixel. Between a fingertip's elements there
/// is none; an even picture has as much.
const MOST_BETWEEN: f64 = 0.25;

/// How much a picture looks like one of a fingertip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Likeness {
    /// Elements whose moments are such as the calibration's loads caused.
    pub alike: usize,
    /// All elements.
    pub elements: usize,
    /// Mean grey level above the ground between the sub-regions, over that within them.
    pub between: f64,
}

impl Likeness {
    /// How much `picture`, and the `moments` of it, look like the fingertip that `calibration` was made with, whose elements
    /// have these `regions` on a ground of `dark_level`.
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

    /// Whether the picture may be of the fingertip.
    pub fn is_enough(&self) -> bool {
        self.alike as f64 >= LEAST_ALIKE * self.elements as f64 && self.between <= MOST_BETWEEN
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
            "{alike} of {elements} elements are where and as bright as they can be ({:.0} expected), and between them it is {between:.2} \
             times as bright as at them (at most {MOST_BETWEEN} expected)",
            (LEAST_ALIKE * *elements as f64).ceil()
        )
    }
}

/// Mean grey level above `dark_level` of the pixels that are in no region but within the rectangle about all of them, over that
/// of the pixels in regions; infinite where all of those are dark.
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
