//! Options of `feeler calibrate FOLDER --live CAMERA --force-sensor ADDRESS`.

use super::{Arguments, CommandError};
use crate::camera::CameraArguments;
use feeler::sensor::calibration::{ForceAxes, Goal};
use feeler_lab::sensor::SensorGeometry;
use feeler_sensing::CameraOptions;
use feeler_sensing::calibration::{self, ForceAddress, GuideOptions, Procedure};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct LiveArguments {
    /// Guide through loading the fingertip, mounted on a force sensor, under this camera.
    ///
    /// The camera is /dev/videoN, genicam:ID as listed by `feeler cameras`, or - for raw gray frames of the
    /// fingertip's size on standard input. LOADS.csv then names the folder for the images and their table (LOADS.csv,
    /// or FORCES.csv with --wrench). After Ctrl-C, the same command continues in that folder.
    #[arg(long, value_name = "CAMERA", requires_all = ["force_sensor", "input"], conflicts_with = "simulated")]
    pub live: Option<PathBuf>,
    #[command(flatten)]
    pub rig: RigArguments,
}

/// Force sensor and camera of a guided procedure, for commands with the option `--live`.
#[derive(Debug, clap::Args)]
pub struct RigArguments {
    /// Force sensor under the fingertip: netft://HOST or ros2:/TOPIC.
    ///
    /// netft://HOST is an ATI Net F/T sensor (RDT over UDP); its web page provides the counts per unit, unless they
    /// are given as netft://HOST?cpf=COUNTS&cpt=COUNTS (counts per newton and per newton metre). ros2:/TOPIC is a
    /// topic of geometry_msgs/WrenchStamped in N and N m, by default from the router at tcp/localhost:7447 in the
    /// domain ROS_DOMAIN_ID; override both with ros2:/TOPIC?connect=tcp/HOST:PORT&domain=NUMBER.
    #[arg(long, value_name = "ADDRESS", requires = "live")]
    force_sensor: Option<ForceAddress>,
    /// Frame rate requested from the camera (Hz).
    #[arg(long, value_name = "HZ", default_value_t = 30.0, requires = "live", value_parser = crate::options::parse_rate)]
    rate: f64,
    #[command(flatten)]
    camera: CameraArguments,
}

impl RigArguments {
    /// Returns the options of a guided procedure with the camera `live`, and with forces in `axes`.
    ///
    /// # Errors
    /// If no force sensor is given.
    pub fn options<'a>(
        &'a self,
        live: &'a Path,
        axes: ForceAxes,
    ) -> Result<GuideOptions<'a>, CommandError> {
        let force_sensor = self.force_sensor.as_ref();
        Ok(GuideOptions {
            camera: live,
            rate: self.rate,
            settings: CameraOptions::from(&self.camera),
            force_sensor: force_sensor.ok_or("--live requires --force-sensor")?,
            axes,
        })
    }

    /// Rejects camera options that would have no effect with the camera `live`, if any.
    ///
    /// # Errors
    /// If there is such an option.
    pub fn check_options(&self, live: Option<&Path>) -> Result<(), CommandError> {
        let Some(option) = CameraOptions::from(&self.camera).given() else {
            return Ok(());
        };
        match live {
            None => Err(format!("{option} requires --live CAMERA").into()),
            Some(live) if live == Path::new("-") => {
                Err(format!("{option} requires a camera; --live - reads standard input").into())
            }
            Some(_) => Ok(()),
        }
    }
}

/// Returns the folder of images and loads with `--live`. It is created if missing.
pub fn folder(arguments: &Arguments) -> Option<&Path> {
    let input = arguments.input.as_deref()?;
    arguments.live.live.as_ref().map(|_| Path::new(input))
}

/// Returns the loads that the operator should reach: full scale from the command line, by default 1 N of compression
/// and half of the compression in shear.
fn goal(arguments: &Arguments) -> Goal {
    let normal = arguments.full_scale_normal.unwrap_or(1.0);
    let shear = arguments.full_scale_shear.unwrap_or(0.5 * normal);
    Goal { normal, shear }
}

/// Guides the operator through loading the fingertip. Images and loads are saved in `folder`.
pub fn guide(
    arguments: &Arguments,
    folder: &Path,
    sensor: &SensorGeometry,
) -> Result<(), CommandError> {
    let goal = goal(arguments);
    let procedure = match arguments.wrench {
        true => Procedure::Whole(goal),
        false => Procedure::Elements(goal, arguments.model),
    };
    let live = arguments.live.live.as_deref().unwrap_or(Path::new("-"));
    let axes = arguments.axes.of_sensor()?;
    let options = arguments.live.rig.options(live, axes)?;
    calibration::guide(&options, procedure, folder, sensor)
}
