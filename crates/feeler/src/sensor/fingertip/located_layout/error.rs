//! Errors of layouts.

use super::{LAYOUT_VERSION, MAX_LOCATED_ELEMENTS};
use crate::sensor::fingertip::dome::DomeError;
use crate::sensor::moments::config::MomentsError;

/// Error of creating, reading or using a layout.
#[derive(Debug, thiserror::Error)]
pub enum LayoutError {
    /// The text is not a layout.
    #[error("not a layout file: {0}")]
    Parse(#[from] toml::de::Error),
    /// The layout cannot be written as TOML.
    #[error("failed to write the layout: {0}")]
    Write(#[from] toml::ser::Error),
    /// The file has an unsupported version.
    #[error("expected layout file version {LAYOUT_VERSION}, got {actual}")]
    Version {
        /// Version of the file.
        actual: u32,
    },
    /// The number of elements is out of range.
    #[error("expected 1 to {MAX_LOCATED_ELEMENTS} elements, got {actual}")]
    ElementCount {
        /// Number of elements.
        actual: usize,
    },
    /// A value is invalid.
    #[error("{name}: expected {expected}, got {actual}")]
    Unusable {
        /// Name of the field.
        name: String,
        /// Description of valid values.
        expected: String,
        /// Actual value.
        actual: String,
    },
    /// The geometry of the dome is invalid.
    #[error(transparent)]
    Dome(#[from] DomeError),
    /// An element is outside the visible part of the dome.
    #[error(
        "element {element} at column {column:.1}, row {row:.1} is not on the dome; check the dome's geometry"
    )]
    OffDome {
        /// Index of the element.
        element: usize,
        /// Column of the element's centre, px.
        column: f64,
        /// Row of the element's centre, px.
        row: f64,
    },
    /// The moments of the layout cannot be computed.
    #[error(transparent)]
    Moments(#[from] MomentsError),
}
