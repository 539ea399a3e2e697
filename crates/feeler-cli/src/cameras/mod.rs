//! `feeler cameras`

#[cfg_attr(
    not(all(feature = "genicam", target_os = "linux")),
    path = "no_genicam.rs"
)]
mod genicam;
#[cfg_attr(
    not(all(feature = "camera", target_os = "linux")),
    path = "no_video.rs"
)]
mod video;

use super::{CommandError, Outcome};
use serde_json::{Value, json};
use std::io::Write;

/// Why there are no Video4Linux cameras.
#[cfg(not(all(feature = "camera", target_os = "linux")))]
pub const NO_VIDEO: &str =
    "this program was built without Video4Linux cameras; build it on Linux with --features camera";
/// Why there are no GenICam cameras.
#[cfg(not(all(feature = "genicam", target_os = "linux")))]
pub const NO_GENICAM: &str =
    "this program was built without GenICam cameras; build it on Linux with --features genicam";

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Print JSON, for other programs.
    #[arg(long)]
    json: bool,
    /// List the GenICam camera that Aravis simulates, too: genicam:Fake_1.
    #[arg(long)]
    simulated: bool,
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
    let kinds = [video::list(), genicam::list(arguments.simulated)];
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
