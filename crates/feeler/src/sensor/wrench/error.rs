//! Errors of wrench calibrations.

use crate::sensor::calibration::error::CalibrationError;
use crate::sensor::calibration::load_range::FINGERTIP_RANGE;

/// Supported version of the file.
pub const VERSION: u32 = 1;

/// Error of creating, reading or using a wrench calibration.
#[derive(Debug, thiserror::Error)]
pub enum WrenchError {
    /// The text is not a wrench calibration.
    #[error("not a wrench calibration: {0}")]
    Parse(#[from] toml::de::Error),
    /// The calibration cannot be written as TOML.
    #[error("failed to write the wrench calibration: {0}")]
    Write(#[from] toml::ser::Error),
    /// The file is of another kind or version.
    #[error(
        "expected kind = \"{expected}\" and version = {VERSION}, got kind = {kind:?} and version = {version}; create the file with `feeler calibrate --wrench`"
    )]
    Version {
        /// Expected kind.
        expected: &'static str,
        /// Kind of the file.
        kind: String,
        /// Version of the file.
        version: u32,
    },
    /// The calibration was made for another sensor.
    #[error(transparent)]
    CalibrationTarget(#[from] CalibrationError),
    /// The length of a list is wrong.
    #[error("{what}: expected {expected}, got {actual}")]
    Count {
        /// Name of the list.
        what: String,
        /// Expected length.
        expected: usize,
        /// Actual length.
        actual: usize,
    },
    /// A value in the file is invalid.
    #[error("{field} = {value}: expected {expected}")]
    Value {
        /// Name of the field.
        field: String,
        /// Value found.
        value: String,
        /// Description of valid values.
        expected: &'static str,
    },
    /// The forces are implausibly large or small.
    #[error(
        "the largest force of the calibration is {largest} N; expected {} to {} N on a fingertip: were the forces in another unit? \
         if they are correct, calibrate with `feeler calibrate --wrench --confirm-loads`",
        FINGERTIP_RANGE[0], FINGERTIP_RANGE[1]
    )]
    Magnitude {
        /// The largest measured force, N.
        largest: f64,
    },
    /// There are too few usable samples.
    #[error(
        "expected at least {expected} samples of valid elements with a measured wrench, got {actual}{why}"
    )]
    TooFew {
        /// Minimum number of images.
        expected: usize,
        /// Number of usable images.
        actual: usize,
        /// Reason why other images are unusable; may be empty.
        why: String,
    },
    /// No component was measured within its calibrated range during a press.
    #[error(
        "expected presses with a calibrated component, within its calibrated range and stronger than its band of errors; got none"
    )]
    NotMeasured,
    /// The calibration does not contain an error band for a component, because it was fitted to too few samples.
    #[error(
        "{axis} of the calibration has no band of errors, because it was fitted to fewer than 20 samples; calibrate again with more"
    )]
    NoBand {
        /// Name of the component.
        axis: &'static str,
    },
    /// There are too few presses to test a calibration.
    #[error(
        "expected at least {expected} presses, separated by less than a tenth of the largest load, got {actual}"
    )]
    TooFewPresses {
        /// Minimum number of presses.
        expected: usize,
        /// Number of presses.
        actual: usize,
    },
    /// All measured values of a component are outside its calibrated range.
    #[error(
        "expected presses within the calibrated range of {axis}, {}..{} {unit}, got only others", range[0], range[1]
    )]
    OutsideRange {
        /// Name of the component.
        axis: &'static str,
        /// Unit of the component.
        unit: &'static str,
        /// Calibrated range.
        range: [f64; 2],
    },
    /// The calibration was modified after it was written.
    #[error(
        "the calibration was changed after it was written: its checksum is {actual}, expected {expected}; calibrate again"
    )]
    Checksum {
        /// Checksum stored in the file.
        expected: String,
        /// Checksum computed from the contents.
        actual: String,
    },
    /// All measured components are constant.
    #[error("expected a force or torque that changes, but every measured component is constant")]
    Constant,
    /// No component is predicted better than by its mean, on held-out data.
    #[error(
        "the images do not predict the measured wrench: expected a held-out R² above 0, got {found}"
    )]
    ExplainsNothing {
        /// All components with their R².
        found: String,
    },
    /// The regression has no finite solution.
    #[error(
        "the regression of {axis} has no finite solution; check the images and forces for values that are not finite"
    )]
    Unsolvable {
        /// Name of the component.
        axis: &'static str,
    },
    /// A required component is not calibrated.
    #[error("expected f_x, f_y and f_z in the wrench calibration, but {missing} is missing")]
    Missing {
        /// Name of the missing component.
        missing: &'static str,
    },
}
