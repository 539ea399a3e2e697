//! Why a layout cannot be made, read or used.

use super::{LAYOUT_VERSION, MAX_LOCATED_ELEMENTS};
use crate::sensor::{dome::DomeError, moments_config::MomentsError};

/// Why a layout cannot be made, read or used.
#[derive(Debug, thiserror::Error)]
pub enum LayoutError {
    /// The text is no layout.
    #[error("not a layout file: {0}")]
    Parse(#[from] toml::de::Error),
    /// The layout cannot be written as text.
    #[error("the layout cannot be written: {0}")]
    Write(#[from] toml::ser::Error),
    /// The file is of another version.
    #[error("layout file version {LAYOUT_VERSION} expected, got {actual}")]
    Version {
        /// Version of the file.
        actual: u32,
    },
    /// There are no elements, or too many.
    #[error("1 to {MAX_LOCATED_ELEMENTS} elements expected, got {actual}")]
    ElementCount {
        /// How many there are.
        actual: usize,
    },
    /// A value cannot be used.
    #[error("{name}: {expected} expected, got {actual}")]
    Unusable {
        /// The field.
        name: String,
        /// What it must be.
        expected: String,
        /// What it is.
        actual: String,
    },
    /// The dome makes no sense.
    #[error(transparent)]
    Dome(#[from] DomeError),
    /// An element is seen where the camera sees nothing of the dome.
    #[error(
        "element {element} at column {column:.1}, row {row:.1} does not lie on the dome: check its geometry"
    )]
    OffDome {
        /// Its index.
        element: usize,
        /// Column, px.
        column: f64,
        /// Row, px.
        row: f64,
    },
    /// No moments can be taken.
    #[error(transparent)]
    Moments(#[from] MomentsError),
}
