//! Errors of locating elements in an image.

use super::{MAX_SPOTS, MIN_SIZE, PatternDefect, Polarity};

/// Error returned when no elements can be located.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LocateError {
    /// No image was given.
    #[error("expected at least one image of the unloaded sensor, got none")]
    NoPicture,
    /// There are too many images to sum without overflow.
    #[error("expected at most {most} images, got more")]
    TooMany {
        /// Maximum number of images.
        most: usize,
    },
    /// An image is too small.
    #[error("expected an image of at least {MIN_SIZE}x{MIN_SIZE} px, got {width}x{height} px")]
    TooSmall {
        /// Width of the image, px.
        width: usize,
        /// Height of the image, px.
        height: usize,
    },
    /// The size of an image differs from that of the first.
    #[error(
        "expected an image of {expected_width}x{expected_height} px like the first one, got {width}x{height} px with {pixels} values"
    )]
    PictureSize {
        /// Columns of the first image, px.
        expected_width: usize,
        /// Rows of the first image, px.
        expected_height: usize,
        /// Columns of the image, px.
        width: usize,
        /// Rows of the image, px.
        height: usize,
        /// Number of gray values in the image.
        pixels: usize,
    },
    /// The whole image is black.
    #[error(
        "the image is black (brightest pixel {brightest:.0} of 255): check the light in the dome"
    )]
    Black {
        /// Largest gray value.
        brightest: f32,
    },
    /// The whole image is white.
    #[error("the image is white (darkest pixel {darkest:.0} of 255): lower exposure or gain")]
    White {
        /// Smallest gray value.
        darkest: f32,
    },
    /// The image contains no spot.
    #[error(
        "no element found: no spot exceeds the image noise (gray levels {darkest:.0} to {brightest:.0}, noise {noise:.1})"
    )]
    NoElement {
        /// Smallest gray value.
        darkest: f32,
        /// Largest gray value.
        brightest: f32,
        /// Standard deviation of the noise, gray levels.
        noise: f64,
    },
    /// The spots do not form a pattern of markers.
    #[error(
        "not a pattern of markers ({polarity} spots: {spots}): {}; if they are markers, give their diameter (--spot-diameter)",
        list(defects)
    )]
    NoPattern {
        /// Polarity of the spots.
        polarity: Polarity,
        /// Number of spots.
        spots: usize,
        /// Properties in which the spots differ from markers.
        defects: Vec<PatternDefect>,
    },
    /// There are more spots than a sensor can have.
    #[error("expected at most {MAX_SPOTS} spots, got {actual}: does the image show a sensor?")]
    TooManySpots {
        /// Number of spots.
        actual: usize,
    },
    /// A configured value is out of range.
    #[error("{name} must be between {low} and {high}, got {value}")]
    OutOfRange {
        /// Name of the field.
        name: &'static str,
        /// Minimum value.
        low: f64,
        /// Maximum value.
        high: f64,
        /// The value given.
        value: f64,
    },
}

/// Joins the messages of `defects` with semicolons.
pub(super) fn list(defects: &[PatternDefect]) -> String {
    let named: Vec<String> = defects.iter().map(ToString::to_string).collect();
    named.join("; ")
}
