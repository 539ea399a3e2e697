//! In which axes forces are, and on what they act.

use super::CommandError;
use feeler::sensor::live_calibration::ForceAxes;

/// The body on which forces act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
enum Body {
    /// The fingertip, by what touches it.
    #[default]
    Finger,
    /// What touches the fingertip.
    Object,
}

/// How forces are turned into those on the fingertip, in its axes.
#[derive(Debug, Clone, clap::Args)]
pub struct AxesArguments {
    /// The axes that are x, y and z of the fingertip, as in z,x,-y. Of LOADS.csv: the columns that are f_x, f_y and f_z of an element
    /// (x,y,-z: f_z is tension). With --live, the force sensor's: of a fingertip of known dome x is its axis, outward; of a layout
    /// without one, x is to the right in the picture, y down and z away from the camera; with --wrench, z is the fingertip's axis,
    /// outward, so that pressing makes f_z negative [default: x,y,z]
    #[arg(
        long,
        value_name = "AXES",
        allow_hyphen_values = true,
        conflicts_with = "simulated"
    )]
    force_axes: Option<ForceAxes>,
    /// The body on which the forces of LOADS.csv act, in the axes of an element: on the object they are the opposite of those on the
    /// finger, so that f_z is negative when pressed.
    #[arg(long, value_name = "BODY", default_value = "finger", conflicts_with_all = ["simulated", "live", "wrench"])]
    force_on: Body,
}

impl AxesArguments {
    /// Axes of the columns of a table.
    pub fn of_columns(&self) -> ForceAxes {
        let axes = self.force_axes.unwrap_or_default();
        match self.force_on {
            Body::Finger => axes,
            Body::Object => axes.reversed(),
        }
    }

    /// Axes of a force sensor.
    ///
    /// # Errors
    /// If they are left-handed.
    pub fn of_sensor(&self) -> Result<ForceAxes, CommandError> {
        let axes = self.force_axes.unwrap_or_default();
        match axes.is_rotation() {
            true => Ok(axes),
            false => Err("--force-axes: left-handed: a sign or the order is wrong; expected three axes of the force sensor, as in \"x,y,z\" or \
                \"z,x,-y\"".into()),
        }
    }

    /// Whether any conversion was given.
    pub fn are_given(&self) -> bool {
        self.force_axes.is_some() || self.force_on == Body::Object
    }
}
