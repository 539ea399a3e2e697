//! How moments are taken, and why they cannot be.

use super::polarity::Polarity;
use crate::check::Checker;
use serde::{Deserialize, Serialize};

/// How the moments of a sub-region are taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MomentsConfig {
    /// Grey level up to which a pixel counts as dark; a little above the background, so that its
    /// noise does not reach the sums (assumed). Of dark elements: the level from which on a pixel is ground.
    pub dark_level: u8,
    /// Radius of an element's sub-region about the element's axis, m (assumed: half the pitch of
    /// the outermost ring, so that sub-regions just do not overlap).
    pub subregion_radius: f64,
    /// Whether elements are bright on dark ground or dark on bright ground.
    #[serde(skip_serializing_if = "Polarity::is_bright")]
    pub polarity: Polarity,
}

impl Default for MomentsConfig {
    fn default() -> Self {
        Self {
            dark_level: 24,
            subregion_radius: 2.6e-3,
            polarity: Polarity::Bright,
        }
    }
}

impl MomentsConfig {
    /// Requires every value of the table `key` to be in its range, on a dome of `dome_radius`, m.
    pub fn check(&self, key: &str, dome_radius: f64, checker: &mut Checker) {
        let radius = self.subregion_radius;
        checker.between(
            &format!("{key}.subregion_radius"),
            radius,
            1e-6,
            dome_radius,
        );
    }
}

/// Why moments cannot be taken.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MomentsError {
    /// The sub-region's radius is useless.
    #[error(
        "subregion_radius must lie between 0 and the dome's radius {dome_radius} m, got {radius} m"
    )]
    Radius {
        /// What it was, m.
        radius: f64,
        /// Radius of the dome, m.
        dome_radius: f64,
    },
    /// An element's sub-region reaches beyond the picture.
    #[error(
        "the sub-region of element {element} reaches {seen_at}, beyond the {width}x{height} px of the picture"
    )]
    OutOfPicture {
        /// Index of the element.
        element: usize,
        /// Column and row, px, or that it is not seen at all.
        seen_at: String,
        /// Columns of the picture, px.
        width: usize,
        /// Rows of the picture, px.
        height: usize,
    },
    /// A picture has another size than the kernel was built for.
    #[error(
        "moments are taken of {expected_width}x{expected_height} px, the picture has {width}x{height} px in {pixels} values"
    )]
    PictureSize {
        /// Columns that the kernel was built for, px.
        expected_width: usize,
        /// Rows that the kernel was built for, px.
        expected_height: usize,
        /// Columns of the picture, px.
        width: usize,
        /// Rows of the picture, px.
        height: usize,
        /// Gray values in the picture.
        pixels: usize,
    },
    /// The place for the moments, or the ground's levels, are for another number of elements.
    #[error("the kernel has {expected} elements, what is to go with them is for {actual}")]
    ElementCount {
        /// Elements of the kernel.
        expected: usize,
        /// Elements of the moments to fill, or levels.
        actual: usize,
    },
}
