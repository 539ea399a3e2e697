//! Camera options of the command line.

use crate::options::parse_between;
use feeler_sensing::CameraOptions;
use feeler_sources::Trigger;

/// Settings of a camera besides size and rate.
#[derive(Debug, clap::Args)]
pub struct CameraArguments {
    /// Exposure time of the camera (s) [default: the camera's current setting]
    #[arg(long, value_name = "SECONDS", value_parser = parse_exposure)]
    exposure: Option<f64>,
    /// Gain of the camera, in the unit listed by `feeler cameras` [default: the camera's current setting]
    #[arg(long, value_name = "GAIN", value_parser = parse_gain)]
    gain: Option<f64>,
    /// Column and row of the sensor at which the region of interest begins (px; GenICam only) [default: 0,0]
    #[arg(long, value_name = "COLUMN,ROW", value_parser = parse_offset)]
    roi_offset: Option<(usize, usize)>,
    /// Frame trigger: `free`, `software` or an input line, e.g. Line0 (GenICam only) [default: free]
    ///
    /// `free` uses the camera's internal clock, `software` a command at --rate, and a line the signal at that input.
    #[arg(long, value_name = "free|software|LINE")]
    trigger: Option<Trigger>,
}

impl From<&CameraArguments> for CameraOptions {
    fn from(arguments: &CameraArguments) -> Self {
        Self {
            exposure: arguments.exposure,
            gain: arguments.gain,
            roi_offset: arguments.roi_offset,
            trigger: arguments.trigger.clone(),
        }
    }
}

/// Parses a size in pixels, such as 640x480.
///
/// # Errors
/// If it is not WIDTHxHEIGHT or out of range; the message states the expected form.
pub fn parse_size(text: &str) -> Result<(usize, usize), String> {
    let side = |side: &str| side.parse().ok().filter(|side| (1..=16_384).contains(side));
    let size = text.split_once('x');
    size.and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| "expected WIDTHxHEIGHT of 1 to 16384 px each, as in 640x480".into())
}

fn parse_exposure(text: &str) -> Result<f64, String> {
    parse_between(text, 1e-6, 1e3, "s")
}

fn parse_gain(text: &str) -> Result<f64, String> {
    let gain = text.parse::<f64>().ok().filter(|gain| gain.is_finite());
    gain.ok_or_else(|| "expected a number".into())
}

fn parse_offset(text: &str) -> Result<(usize, usize), String> {
    let place = |place: &str| place.trim().parse().ok().filter(|place| *place <= 65_535);
    let offset = text.split_once(',');
    offset
        .and_then(|(column, row)| Some((place(column)?, place(row)?)))
        .ok_or_else(|| "expected COLUMN,ROW from 0 to 65535 px each, e.g. 640,480".into())
}
