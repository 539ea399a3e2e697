//! Options of `feeler calibrate FOLDER --live CAMERA --force-sensor ADDRESS`.

use super::{Arguments, CommandError};
use crate::camera::CameraArguments;
use feeler::sensor::live_calibration::Goal;
use feeler_lab::sensor::SensorGeometry;
use feeler_sensing::CameraOptions;
use feeler_sensing::calibration::{self, ForceAddress, GuideOptions};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct LiveArguments {
    /// Guide through loading the fingertip, which stands on a force sensor, under this camera: /dev/videoN, genicam:ID as `feeler
    /// cameras` lists it, or - for raw gray frames of the fingertip's size on standard input. LOADS.csv is then the folder that
    /// pictures and their LOADS.csv (with --wrench, FORCES.csv) are kept in, and found again after Ctrl-C.
    #[arg(long, value_name = "CAMERA", requires_all = ["force_sensor", "input"], conflicts_with = "simulated")]
    pub live: Option<PathBuf>,
    /// The force sensor under the fingertip: netft://HOST (ATI Net F/T, RDT over UDP), whose web page says what its counts mean, or
    /// netft://HOST?cpf=COUNTS&cpt=COUNTS, with the counts per newton and newton metre; or ros2:/TOPIC of geometry_msgs/WrenchStamped, N and
    /// N m, whose graph's router is at tcp/localhost:7447 and whose domain is ROS_DOMAIN_ID unless told otherwise:
    /// ros2:/TOPIC?connect=tcp/HOST:PORT&domain=NUMBER
    #[arg(long, value_name = "ADDRESS", requires = "live")]
    force_sensor: Option<ForceAddress>,
    /// Frames per second that the camera is asked for.
    #[arg(long, value_name = "HZ", default_value_t = 30.0, requires = "live", value_parser = crate::options::parse_rate)]
    rate: f64,
    #[command(flatten)]
    camera: CameraArguments,
}

impl LiveArguments {
    /// Refuses what would change nothing.
    pub fn refuse_without_effect(&self) -> Result<(), CommandError> {
        let Some(option) = CameraOptions::from(&self.camera).given() else {
            return Ok(());
        };
        match &self.live {
            None => {
                Err(format!("{option} is for a camera; expected --live CAMERA beside it").into())
            }
            Some(live) if live == Path::new("-") => {
                Err(format!("{option} is for a camera; - is something else").into())
            }
            Some(_) => Ok(()),
        }
    }
}

/// The folder of pictures and loads, which is made if there is none.
pub fn folder(arguments: &Arguments) -> Option<&Path> {
    let input = arguments.input.as_deref()?;
    arguments.live.live.as_ref().map(|_| Path::new(input))
}

/// What a person should reach: full scale, as far as the command line says; by default 1 N, and half of it of shear.
fn goal(arguments: &Arguments) -> Goal {
    let normal = arguments.full_scale_normal.unwrap_or(1.0);
    let shear = arguments.full_scale_shear.unwrap_or(0.5 * normal);
    Goal { normal, shear }
}

/// Guides through loading the fingertip, with images and loads kept in `folder`.
pub fn guide(
    arguments: &Arguments,
    folder: &Path,
    sensor: &SensorGeometry,
) -> Result<(), CommandError> {
    let live = &arguments.live;
    let force_sensor = live.force_sensor.as_ref();
    let options = GuideOptions {
        camera: live.live.as_deref().unwrap_or(Path::new("-")),
        rate: live.rate,
        settings: CameraOptions::from(&live.camera),
        force_sensor: force_sensor.ok_or("--live: expected --force-sensor, too")?,
        goal: goal(arguments),
        axes: arguments.axes.of_sensor()?,
        model: (!arguments.wrench).then_some(arguments.model),
    };
    calibration::guide(&options, folder, sensor)
}
