//! Error of simulated optics.

/// Error when creating or rendering a simulated fingertip.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OpticsError {
    /// A parameter is out of its range.
    #[error("{name} must lie between {low} and {high}, got {value}")]
    OutOfRange {
        /// Name of the field.
        name: &'static str,
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
        /// Value of the field.
        value: f64,
    },
    /// A cone of an unloaded element does not touch the visible part of the dome.
    #[error("the cones of element {element} are not visible to the camera")]
    Unseen {
        /// Index of the element.
        element: usize,
    },
    /// The number of forces differs from the number of elements.
    #[error("expected forces for {expected} elements, got {actual}")]
    ElementCount {
        /// Number of elements of the fingertip.
        expected: usize,
        /// Number of forces.
        actual: usize,
    },
    /// The size of the image differs from the resolution of the camera.
    #[error(
        "expected an image of {expected_width}x{expected_height} px, got {width}x{height} px in {pixels} values"
    )]
    PictureSize {
        /// Width of the camera's images (px).
        expected_width: usize,
        /// Height of the camera's images (px).
        expected_height: usize,
        /// Width of the image (px).
        width: usize,
        /// Height of the image (px).
        height: usize,
        /// Number of gray values in the image.
        pixels: usize,
    },
}

/// Checks values, given as `(name, value, lowest, highest)`.
pub(crate) fn in_range(values: &[(&'static str, f64, f64, f64)]) -> Result<(), OpticsError> {
    let out = values
        .iter()
        .find(|(_, value, low, high)| !(low..=high).contains(&value));
    match out {
        None => Ok(()),
        Some(&(name, value, low, high)) => Err(OpticsError::OutOfRange {
            name,
            low,
            high,
            value,
        }),
    }
}
