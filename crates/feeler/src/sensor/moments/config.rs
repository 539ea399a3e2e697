//! Configuration of the moments, and errors of computing them.

use crate::check::Checker;
use crate::sensor::image::polarity::Polarity;
use serde::{Deserialize, Serialize};

/// Parameters for computing the moments of sub-regions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MomentsConfig {
    /// Maximum gray level of dark pixels, slightly above the background so that its noise does not affect the sums
    /// (assumed). For dark elements: minimum gray level of the background.
    pub dark_level: u8,
    /// Radius of an element's sub-region about the element's axis, m (assumed: half the pitch of the outermost ring,
    /// so that sub-regions just do not overlap).
    pub subregion_radius: f64,
    /// Polarity of the elements: bright on a dark background or dark on a bright one.
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
    /// Checks that every value of the table `key` is in its range, for a dome of `dome_radius`, m.
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

/// Error of computing moments.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MomentsError {
    /// The radius of the sub-regions is out of range.
    #[error(
        "subregion_radius must lie between 0 and the dome's radius {dome_radius} m, got {radius} m"
    )]
    Radius {
        /// The invalid radius, m.
        radius: f64,
        /// Radius of the dome, m.
        dome_radius: f64,
    },
    /// The sub-region of an element extends beyond the image.
    #[error(
        "the sub-region of element {element} reaches {seen_at}, beyond the {width}x{height} px of the image"
    )]
    OutOfPicture {
        /// Index of the element.
        element: usize,
        /// Column and row that the sub-region reaches, px, or a note that the element is not visible.
        seen_at: String,
        /// Columns of the image, px.
        width: usize,
        /// Rows of the image, px.
        height: usize,
    },
    /// The size of an image does not match the kernel.
    #[error(
        "expected an image of {expected_width}x{expected_height} px, got {width}x{height} px in {pixels} values"
    )]
    PictureSize {
        /// Columns expected by the kernel, px.
        expected_width: usize,
        /// Rows expected by the kernel, px.
        expected_height: usize,
        /// Columns of the image, px.
        width: usize,
        /// Rows of the image, px.
        height: usize,
        /// Number of gray values in the image.
        pixels: usize,
    },
    /// The number of moments to fill, or of background levels, does not match the kernel's number of elements.
    #[error("expected moments or background levels for {expected} elements, got {actual}")]
    ElementCount {
        /// Number of elements of the kernel.
        expected: usize,
        /// Number of moments to fill, or of levels.
        actual: usize,
    },
}
