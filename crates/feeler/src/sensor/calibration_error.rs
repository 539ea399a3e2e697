//! Why a calibration cannot be made, read or used.

use super::{calibration::CALIBRATION_VERSION, load_check::ELEMENT_RANGE};

/// Why a calibration cannot be made, read or used.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    /// The text is no calibration.
    #[error("not a calibration file: {0}")]
    Parse(#[from] toml::de::Error),
    /// The calibration cannot be written as text.
    #[error("the calibration cannot be written: {0}")]
    Write(#[from] toml::ser::Error),
    /// The file is of another version.
    #[error(
        "calibration file version {CALIBRATION_VERSION} expected, got {actual}; \
         `feeler calibrate` makes one of this version"
    )]
    Version {
        /// Version of the file.
        actual: u32,
    },
    /// The calibration was made for another fingertip.
    #[error(
        "the calibration is for another fingertip: {part} has {key} = {expected} here, \
         {actual} in the calibration; `feeler calibrate` makes one for the fingertip here"
    )]
    OtherFingertip {
        /// What differs: the layout, the camera or the moments.
        part: &'static str,
        /// The first value of it that differs.
        key: String,
        /// As configured.
        expected: String,
        /// As calibrated.
        actual: String,
    },
    /// What the file says of its fingertip does not have the hash that stands beside it.
    #[error(
        "made_for.fingertip has the SHA-256 {expected}, made_for.sha256 = {actual}: \
         one of them was changed after calibrating"
    )]
    Hash {
        /// Hash of the fingertip in the file.
        expected: String,
        /// Hash that stands in the file.
        actual: String,
    },
    /// A number of elements, or of lists of loads, is wrong.
    #[error("{what} for {expected} elements expected, got {actual}")]
    ElementCount {
        /// What was counted.
        what: &'static str,
        /// Elements of the fingertip.
        expected: usize,
        /// How many arrived.
        actual: usize,
    },
    /// Forces point against what pictures show.
    #[error(
        "{force} is reversed in {reversed} of {elements} elements: the calibration would report {} (expected {}); its loads had the \
         wrong sign or axis, `feeler calibrate` makes one of loads that fit the pictures",
        if *force == "f_z" { "tension where an element is pressed" } else { "shear against the way in which an element is dragged" },
        if *force == "f_z" { "compression, which is positive when pressed" } else { "shear along the displacement of the centroid" }
    )]
    Reversed {
        /// The component of the force.
        force: &'static str,
        /// Elements in which it is reversed.
        reversed: usize,
        /// All elements.
        elements: usize,
    },
    /// Its forces are too large or too small.
    #[error(
        "full_scale is {full_scale} N, forces are up to {largest:.3} N; expected {} to {} N on a soft element: were its loads in another unit? \
         `feeler calibrate --confirm-loads` makes one of loads that are so",
        ELEMENT_RANGE[0], ELEMENT_RANGE[1]
    )]
    Magnitude {
        /// The larger of its full scales, N.
        full_scale: f64,
        /// The largest force within its ranges, N.
        largest: f64,
    },
    /// A full scale is no force.
    #[error("full_scale.{key} = {actual}: expected a force in N that is not negative")]
    FullScale {
        /// `normal` or `shear`.
        key: &'static str,
        /// As in the file, N.
        actual: f64,
    },
    /// A number in the calibration is not usable, or an element's loads do not determine one.
    #[error("element {element}: {what}")]
    Unusable {
        /// Index of the element.
        element: usize,
        /// Expected and actual.
        what: String,
    },
}
