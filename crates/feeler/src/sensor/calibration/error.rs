//! Errors of calibrations.

use super::load_range::ELEMENT_RANGE;

/// Version of the calibration file format.
pub const CALIBRATION_VERSION: u32 = 2;

/// Error of making, reading or using a calibration.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    /// The text is not a calibration.
    #[error("not a calibration file: {0}")]
    Parse(#[from] toml::de::Error),
    /// The calibration cannot be formatted.
    #[error("the calibration cannot be written: {0}")]
    Write(#[from] toml::ser::Error),
    /// The file has an unsupported version.
    #[error(
        "expected calibration file version {CALIBRATION_VERSION}, got {actual}; \
         run `feeler calibrate` to make one of this version"
    )]
    Version {
        /// Version of the file.
        actual: u32,
    },
    /// The calibration was made for another fingertip.
    #[error(
        "the calibration is for another fingertip: {part} has {key} = {expected} in the configuration, \
         {actual} in the calibration; run `feeler calibrate` to make one for this fingertip"
    )]
    OtherFingertip {
        /// Part that differs: the layout, the camera or the moments.
        part: &'static str,
        /// Key of the first value that differs.
        key: String,
        /// Configured value.
        expected: String,
        /// Value in the calibration.
        actual: String,
    },
    /// The description of the fingertip in the file does not match its hash.
    #[error(
        "made_for.fingertip has the SHA-256 {expected}, but made_for.sha256 = {actual}: \
         one of them was changed after the calibration"
    )]
    Hash {
        /// Hash computed from the fingertip in the file.
        expected: String,
        /// Hash in the file.
        actual: String,
    },
    /// The number of elements, or of the lists of loads, differs from the fingertip's.
    #[error("expected {what} for {expected} elements, got {actual}")]
    ElementCount {
        /// Name of the counted items.
        what: &'static str,
        /// Number of elements of the fingertip.
        expected: usize,
        /// Number of items found.
        actual: usize,
    },
    /// The sign of a force component contradicts the images in most elements.
    #[error(
        "{force} is reversed in {reversed} of {elements} elements: the calibration would report {} (expected {}); its loads have the \
         wrong sign or axis; correct them and run `feeler calibrate` again",
        if *force == "f_z" { "tension where an element is pressed" } else { "shear against the displacement of the centroid" },
        if *force == "f_z" { "compression, which is positive when pressed" } else { "shear along the displacement of the centroid" }
    )]
    Reversed {
        /// Name of the reversed force component.
        force: &'static str,
        /// Number of elements in which it is reversed.
        reversed: usize,
        /// Number of all elements.
        elements: usize,
    },
    /// The forces are implausibly large or small.
    #[error(
        "full_scale is {full_scale} N, forces are up to {largest:.3} N; expected {} to {} N on a soft element: are its loads in another unit? \
         If not, run `feeler calibrate --confirm-loads`",
        ELEMENT_RANGE[0], ELEMENT_RANGE[1]
    )]
    Magnitude {
        /// The larger of the full scales, N.
        full_scale: f64,
        /// Largest force within the ranges, N.
        largest: f64,
    },
    /// A full-scale force is negative or not finite.
    #[error("full_scale.{key} = {actual}: expected a non-negative force in N")]
    FullScale {
        /// Name of the full scale: `normal` or `shear`.
        key: &'static str,
        /// Value in the file, N.
        actual: f64,
    },
    /// A value in the calibration is invalid, or an element's loads are insufficient for a fit.
    #[error("element {element}: {what}")]
    Unusable {
        /// Index of the element.
        element: usize,
        /// Description of the problem, with the expected and the actual value.
        what: String,
    },
}
