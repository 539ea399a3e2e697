//! `feeler cameras`

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

use super::camera::CameraArguments;
use super::camera::parse_size;
use super::{CommandError, Outcome};
use crate::options::parse_rate;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Print JSON, for other programs.
    #[arg(long)]
    json: bool,
    /// List the GenICam camera that Aravis simulates, too: genicam:Fake_1.
    #[arg(long)]
    simulated: bool,
    /// Take pictures for 5 seconds from this camera (/dev/video0, genicam:ID) or the only one, and report the achieved rate, lost
    /// pictures, bandwidth, time of decoding, and jitter of the stamps. Ctrl-C reports what was measured until then.
    #[arg(long, value_name = "CAMERA", num_args = 0..=1)]
    measure: Option<Option<PathBuf>>,
    /// Size of the pictures of --measure, px.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, default_value = "640x480", requires = "measure")]
    size: (usize, usize),
    /// Frames per second that --measure requests from the camera.
    #[arg(long, value_name = "HZ", value_parser = parse_rate, default_value_t = 30.0, requires = "measure")]
    rate: f64,
    #[command(flatten)]
    camera: CameraArguments,
}

/// The cameras of a kind.
struct Kind {
    name: &'static str,
    /// What each is called, as a source of `feeler sense`; what it can do, in words and as JSON.
    cameras: Vec<Listed>,
    /// What is missing to find more of them, if anything.
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
        return Err(format!("{option} is for --measure; expected --measure beside it").into());
    }
    let kinds = kinds();
    if arguments.json {
        writeln!(out, "{:#}", as_json(kinds))?;
        return Ok(Outcome::Done);
    }
    for kind in kinds {
        if kind.cameras.is_empty() && kind.missing.is_empty() {
            writeln!(out, "{}: no camera answers", kind.name)?;
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
