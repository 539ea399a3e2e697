//! Why no elements can be located in a picture.

use super::{MAX_SPOTS, MIN_SIZE, Polarity, Unlike};

/// Why no elements can be located.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LocateError {
    /// There is no picture.
    #[error("at least one picture of the untouched sensor expected, got none")]
    NoPicture,
    /// There are more pictures than can be added up.
    #[error("at most {most} pictures expected, got more")]
    TooMany {
        /// How many are allowed.
        most: usize,
    },
    /// A picture is too small.
    #[error("a picture of at least {MIN_SIZE}x{MIN_SIZE} px expected, got {width}x{height} px")]
    TooSmall {
        /// Columns, px.
        width: usize,
        /// Rows, px.
        height: usize,
    },
    /// A picture has another size than the first.
    #[error(
        "a picture of {expected_width}x{expected_height} px expected, as the first one, got {width}x{height} px in {pixels} values"
    )]
    PictureSize {
        /// Columns of the first picture, px.
        expected_width: usize,
        /// Rows of the first picture, px.
        expected_height: usize,
        /// Columns of the picture, px.
        width: usize,
        /// Rows of the picture, px.
        height: usize,
        /// Gray values in the picture.
        pixels: usize,
    },
    /// The picture is black all over.
    #[error(
        "the picture is black (brightest pixel {brightest:.0} of 255): is there light in the dome?"
    )]
    Black {
        /// Largest grey value.
        brightest: f32,
    },
    /// The picture is white all over.
    #[error("the picture is white (darkest pixel {darkest:.0} of 255): lower exposure or gain")]
    White {
        /// Least grey value.
        darkest: f32,
    },
    /// There is no spot.
    #[error(
        "no element found: no spot rises above the picture's noise (grey levels {darkest:.0} to {brightest:.0}, noise {noise:.1})"
    )]
    NoElement {
        /// Least grey value.
        darkest: f32,
        /// Largest grey value.
        brightest: f32,
        /// Standard deviation of the noise, grey levels.
        noise: f64,
    },
    /// There are spots, but they are no pattern of markers.
    #[error(
        "the {spots} {polarity} spots found are no pattern of markers: {}; give their diameter (--spot-diameter) if they are some all the same",
        list(unlike)
    )]
    NoPattern {
        /// Whether they are bright or dark.
        polarity: Polarity,
        /// How many there are.
        spots: usize,
        /// What of a pattern they lack.
        unlike: Vec<Unlike>,
    },
    /// There are so many spots that they are no elements.
    #[error("at most {MAX_SPOTS} spots expected, got {actual}: is this a picture of a sensor?")]
    TooManySpots {
        /// How many there are.
        actual: usize,
    },
    /// What was said about the elements makes no sense.
    #[error("{name} must lie between {low} and {high}, got {value}")]
    OutOfRange {
        /// The field.
        name: &'static str,
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
        /// What it was.
        value: f64,
    },
}

/// What spots lack, one after the other.
pub(super) fn list(unlike: &[Unlike]) -> String {
    let named: Vec<String> = unlike.iter().map(ToString::to_string).collect();
    named.join("; ")
}
