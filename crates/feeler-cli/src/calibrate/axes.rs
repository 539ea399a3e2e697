//! Conversion of measured forces to the axes and signs of the fingertip.

use super::CommandError;
use feeler::sensor::calibration::ForceAxes;

/// Body on which the measured forces act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
enum Body {
    /// Forces on the fingertip, exerted by the object.
    #[default]
    Finger,
    /// The object that touches the fingertip.
    Object,
}

/// Options that convert measured forces to forces on the fingertip, in its axes.
#[derive(Debug, Clone, clap::Args)]
pub struct AxesArguments {
    /// Measured axes that are x, y and z of the fingertip, e.g. z,x,-y [default: x,y,z]
    ///
    /// For LOADS.csv: the columns that are f_x, f_y and f_z of an element; use x,y,-z if the column f_z is positive
    /// in tension. With --live: the axes of the force sensor. If the fingertip's dome is known, x of the fingertip is
    /// the dome's axis, pointing outward. For a layout without a dome, x points right in the image, y down and z away
    /// from the camera. With --wrench, z is the fingertip's axis, pointing outward, so that pressing makes f_z
    /// negative.
    #[arg(
        long,
        value_name = "AXES",
        allow_hyphen_values = true,
        conflicts_with = "simulated"
    )]
    force_axes: Option<ForceAxes>,
    /// Body on which the forces in LOADS.csv act, in the axes of an element.
    ///
    /// Forces on the object are the negative of those on the finger: f_z is negative when pressed.
    #[arg(long, value_name = "BODY", default_value = "finger", conflicts_with_all = ["simulated", "live", "wrench"])]
    force_on: Body,
}

impl AxesArguments {
    /// Returns the conversion from the force columns of a table to the axes of the fingertip.
    pub fn of_columns(&self) -> ForceAxes {
        let axes = self.force_axes.unwrap_or_default();
        match self.force_on {
            Body::Finger => axes,
            Body::Object => axes.reversed(),
        }
    }

    /// Returns the conversion from the axes of a force sensor to those of the fingertip.
    ///
    /// # Errors
    /// If the axes are left-handed.
    pub fn of_sensor(&self) -> Result<ForceAxes, CommandError> {
        right_handed(self.force_axes.unwrap_or_default())
    }

    /// Returns `true` if any conversion was given.
    pub fn are_given(&self) -> bool {
        self.force_axes.is_some() || self.force_on == Body::Object
    }
}

/// Returns `axes` if they are right-handed.
///
/// # Errors
/// If `axes` are left-handed.
pub fn right_handed(axes: ForceAxes) -> Result<ForceAxes, CommandError> {
    match axes.is_rotation() {
        true => Ok(axes),
        false => Err("--force-axes: expected right-handed axes of the force sensor, e.g. x,y,z or z,x,-y, got left-handed axes; check their \
                order and signs".into()),
    }
}
