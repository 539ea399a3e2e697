//! The `feeler verify` subcommand.

use super::{CommandError, Outcome};
use crate::calibrate::axes::right_handed;
use crate::calibrate::live::RigArguments;
use crate::options::{Json, Overwrite, parse_between};
use feeler::sensor::calibration::ForceAxes;
use feeler_sensing::TaxelOptions;
use feeler_sensing::calibration::VerifyOptions;
use std::io::Write;
use std::path::PathBuf;

const DETAILS: &str = "\
A press is a run of samples with more than a tenth of the largest load; for places of contact without forces, a run at the same place. A press is outside if more than half of its samples are farther from the measured value than the calibration's 95 % band, or unlike the calibration's samples. A component is rejected if more presses are outside than chance explains. A drift within the band is reported, but not rejected.

Exit status 0: still valid; 1: no longer valid; 2: cannot be tested.";

#[derive(Debug, clap::Args)]
#[command(after_long_help = DETAILS)]
pub struct Arguments {
    /// Wrench calibration, written by `feeler calibrate --wrench`.
    calibration: PathBuf,
    /// Table of presses with measured forces, in the format of `feeler calibrate --wrench`. Five presses are enough for
    /// one component. With --live: new folder for the images and their table.
    #[arg(value_name = "FORCES.csv|FOLDER")]
    presses: PathBuf,
    /// Guide through presses of the fingertip on a force sensor, under this camera.
    ///
    /// The camera is /dev/videoN, genicam:ID as listed by `feeler cameras`, or - for raw gray frames of the
    /// fingertip's size on standard input. Only forces are tested, not torques.
    #[arg(
        long,
        value_name = "CAMERA",
        requires = "force_sensor",
        conflicts_with = "taxels"
    )]
    live: Option<PathBuf>,
    /// Number of presses to guide through with --live (3 to 100).
    #[arg(long = "presses", value_name = "NUMBER", default_value_t = 5, requires = "live", value_parser = clap::value_parser!(u32).range(3..=100))]
    press_count: u32,
    /// Axes of the force sensor that are x, y and z of the fingertip, z pointing outward, e.g. z,x,-y [default: x,y,z]
    #[arg(
        long,
        value_name = "AXES",
        allow_hyphen_values = true,
        requires = "live"
    )]
    force_axes: Option<ForceAxes>,
    #[command(flatten)]
    rig: RigArguments,
    /// Layout of the taxel array: a file or a built-in one (see `feeler list`).
    #[arg(long, value_name = "LAYOUT", conflicts_with_all = ["layout", "experiment", "finger"])]
    taxels: Option<String>,
    /// Prefix of the array's columns if tables have several arrays, for example left.
    #[arg(long, value_name = "PREFIX", requires = "taxels")]
    prefix: Option<String>,
    /// Layout file of the sensing elements, written by `feeler locate`, instead of an experiment.
    #[arg(long, value_name = "LAYOUT.toml", conflicts_with = "experiment")]
    layout: Option<PathBuf>,
    /// Experiment that defines the fingertip: a file, or the name of a built-in one.
    #[arg(long, value_name = "EXPERIMENT", default_value = "cap-closing")]
    experiment: String,
    /// Index of the finger with this fingertip [default: the fingertip shared by all fingers]
    #[arg(long, value_name = "NUMBER", conflicts_with = "layout")]
    finger: Option<usize>,
    /// Maximum probability of rejecting a calibration that is still valid, if presses are independent. If all presses
    /// are off together, it is at most 10 %.
    #[arg(long, value_name = "PROBABILITY", default_value_t = 0.01, value_parser = parse_rate)]
    false_alarm_rate: f64,
    /// File for a copy of the calibration whose passport contains the result; `feeler sense --verified-within` requires one.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    #[command(flatten)]
    json: Json,
}

fn parse_rate(text: &str) -> Result<f64, String> {
    parse_between(text, 1e-6, 0.1, "of valid calibrations")
}

/// Tests whether a calibration is still valid.
pub fn verify(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let live = arguments.live.as_deref();
    arguments.rig.check_options(live)?;
    let axes = right_handed(arguments.force_axes.unwrap_or_default())?;
    let rig = live.map(|live| arguments.rig.options(live, axes));
    let options = VerifyOptions {
        live: rig.transpose()?.map(|rig| (rig, arguments.press_count)),
        calibration: arguments.calibration.clone(),
        presses: arguments.presses.clone(),
        taxels: TaxelOptions {
            taxels: arguments.taxels.clone(),
            prefix: arguments.prefix.clone(),
            ..TaxelOptions::default()
        },
        layout: arguments.layout.clone(),
        experiment: arguments.experiment.clone(),
        finger: arguments.finger,
        false_alarm_rate: arguments.false_alarm_rate,
        output: arguments.output.clone(),
        force: arguments.overwrite.force,
        json: arguments.json.json,
    };
    feeler_sensing::calibration::verify(&options, out)
}
