//! The `feeler cameras` subcommand.

#[cfg_attr(
    not(all(feature = "genicam", target_os = "linux")),
    path = "no_genicam.rs"
)]
mod genicam;
mod measure;
mod measured;
#[cfg_attr(
    not(all(feature = "camera", target_os = "linux")),
    path = "no_video.rs"
)]
mod video;

use super::camera::{CameraArguments, parse_size};
use super::{CommandError, Outcome};
use crate::options::parse_rate;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Print JSON instead of text (see docs/json.md).
    #[arg(long)]
    json: bool,
    /// Include the GenICam camera simulated by Aravis, genicam:Fake_1.
    #[arg(long)]
    simulated: bool,
    /// Measure this camera, or the only one, for 5 seconds.
    ///
    /// Reports the achieved frame rate, lost images, bandwidth, decoding time and jitter of the stamps. CAMERA is
    /// e.g. /dev/video0 or genicam:ID. Ctrl-C ends the measurement early.
    #[arg(long, value_name = "CAMERA", num_args = 0..=1)]
    measure: Option<Option<PathBuf>>,
    /// Image size for --measure (px).
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, default_value = "640x480", requires = "measure")]
    size: (usize, usize),
    /// Frame rate that --measure requests (Hz).
    #[arg(long, value_name = "HZ", value_parser = parse_rate, default_value_t = 30.0, requires = "measure")]
    rate: f64,
    #[command(flatten)]
    camera: CameraArguments,
}

/// Cameras of one kind.
struct Kind {
    name: &'static str,
    /// Cameras found: name as accepted by `feeler sense`, and capabilities as text and JSON.
    cameras: Vec<Listed>,
    /// Reasons why some cameras may not have been found.
    missing: Vec<String>,
}

struct Listed {
    name: String,
    words: Vec<String>,
    json: Value,
}

pub fn cameras(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let kinds = || [video::list(), genicam::list(arguments.simulated)];
    if let Some(named) = &arguments.measure {
        return measure::measure(arguments, named.as_deref(), kinds, out);
    }
    if let Some(option) = feeler_sensing::CameraOptions::from(&arguments.camera).given() {
        return Err(format!("{option} requires --measure").into());
    }
    let kinds = kinds();
    if arguments.json {
        writeln!(out, "{:#}", as_json(kinds))?;
        return Ok(Outcome::Done);
    }
    for kind in kinds {
        if kind.cameras.is_empty() && kind.missing.is_empty() {
            writeln!(out, "{}: no camera found", kind.name)?;
        }
        for Listed { name, words, .. } in kind.cameras {
            let mut words = words.into_iter();
            writeln!(out, "{name:<24} {}", words.next().unwrap_or_default())?;
            for line in words {
                writeln!(out, "    {line}")?;
            }
        }
        for missing in kind.missing {
            writeln!(out, "{}: {missing}", kind.name)?;
        }
    }
    Ok(Outcome::Done)
}

fn as_json(kinds: [Kind; 2]) -> Value {
    let [video, genicam] = kinds.map(|kind| {
        let cameras: Vec<Value> = kind.cameras.into_iter().map(|camera| camera.json).collect();
        json!({ "cameras": cameras, "missing": kind.missing })
    });
    json!({ "video4linux": video, "genicam": genicam })
}
