//! Why a wrench calibration cannot be made, read or used.

use super::calibration::{KIND, VERSION};
use crate::sensor::calibration_error::CalibrationError;
use crate::sensor::load_check::FINGERTIP_RANGE;

/// Why a wrench calibration cannot be made, read or used.
#[derive(Debug, thiserror::Error)]
pub enum WrenchError {
    /// The text is no wrench calibration.
    #[error("not a wrench calibration: {0}")]
    Parse(#[from] toml::de::Error),
    /// The calibration cannot be written as text.
    #[error("the wrench calibration cannot be written: {0}")]
    Write(#[from] toml::ser::Error),
    /// It is of another kind or version.
    #[error(
        "kind = \"{KIND}\", version = {VERSION} expected, got kind = {kind:?}, version = {version}; `feeler calibrate --wrench` makes one"
    )]
    Version {
        /// Kind of the file.
        kind: String,
        /// Version of the file.
        version: u32,
    },
    /// It was made for another sensor.
    #[error(transparent)]
    MadeFor(#[from] CalibrationError),
    /// A list is for another number of elements, or of something else.
    #[error("{what}: {expected} expected, got {actual}")]
    Count {
        /// What was counted.
        what: String,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        actual: usize,
    },
    /// A value in the file cannot be used.
    #[error("{field} = {value}: expected {expected}")]
    Value {
        /// Where it stands.
        field: String,
        /// What stands there.
        value: String,
        /// What should.
        expected: &'static str,
    },
    /// Its forces are too large or too small.
    #[error(
        "the largest force of the calibration is {largest} N; expected {} to {} N on a fingertip: were its forces in another unit? \
         `feeler calibrate --wrench --confirm-loads` makes one of forces that are so",
        FINGERTIP_RANGE[0], FINGERTIP_RANGE[1]
    )]
    Magnitude {
        /// The largest force that was measured, N.
        largest: f64,
    },
    /// There are too few pictures to learn from.
    #[error(
        "at least {expected} pictures of lit elements with a measured wrench expected, got {actual}{why}"
    )]
    TooFew {
        /// Least number.
        expected: usize,
        /// How many there are.
        actual: usize,
        /// Where the others are, if there are others.
        why: String,
    },
    /// What was measured does not change.
    #[error("a force or torque that changes expected; every measured component is constant")]
    Constant,
    /// On data that it has not seen, no component is predicted better than by its mean.
    #[error(
        "the pictures explain nothing of what was measured: held-out R² above 0 expected, got {found}"
    )]
    ExplainsNothing {
        /// Each component with its R².
        found: String,
    },
    /// The equations have no solution in finite numbers.
    #[error(
        "pictures and forces of finite numbers expected; the regression of {axis} has no solution"
    )]
    Unsolvable {
        /// The component.
        axis: &'static str,
    },
    /// A component is needed that was not calibrated.
    #[error("f_x, f_y and f_z expected in the wrench calibration, {missing} is not there")]
    Missing {
        /// The component.
        missing: &'static str,
    },
}
