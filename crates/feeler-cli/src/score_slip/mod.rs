//! `feeler score-slip`: compares slip detectors with the simulator's ground truth or with labelled recordings.

mod collected;
mod in_order;
mod labels;
mod notes;
mod recorded;
mod said;
mod scores;
mod simulated;
mod sources;
mod taxels;
mod tracks;
mod videos;

use super::json::Json;
use super::part_file::Overwrite;
use super::{CommandError, Outcome};
use feeler_lab::config::BUILT_IN;
use feeler_report::make::create_folder;
use recorded::RecordedArguments;
use std::io::Write;
use std::path::{Path, PathBuf};

/// File name of the page.
const PAGE: &str = "slip.html";

/// Score slip detectors on an experiment or on labelled recordings.
///
/// With one argument, an experiment: detectors are compared with the simulator's ground truth. With LABELS (or
/// --frame-labels), recordings of grasps: detectors are compared with the labels, each with a threshold chosen without
/// the recordings of the same group.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file, name of a built-in experiment, or recordings.
    ///
    /// Of an experiment, the fingertip of finger 0, the noise and the thresholds are used. With LABELS, recordings: a
    /// file or a folder of tables of `feeler sense`, of videos of a marker gel, or, with --taxels, of tables of taxel
    /// arrays.
    #[arg(value_name = "EXPERIMENT|RECORDINGS", default_value = "cap-closing")]
    source: String,
    /// Table with the labels of the recordings.
    ///
    /// The recording is named in the column `recording`, `sequence` or `video`, or else in the first. The column `slip`
    /// contains 0 or 1. If frames are labelled, the column `frame` contains their numbers from 0.
    labels: Option<PathBuf>,
    /// Number of simulated trials to score; as many other trials are used to choose the thresholds.
    #[arg(long, default_value_t = 1000, conflicts_with_all = ["labels", "frame_labels"],
        value_parser = clap::value_parser!(u64).range(1..=100_000))]
    trials: u64,
    /// Set a value of the experiment, as in sim.direct_sensing.shear_noise=0.005.
    #[arg(long = "set", value_name = "KEY=VALUE", conflicts_with_all = ["labels", "frame_labels"])]
    settings: Vec<String>,
    /// Random seed of the simulation.
    #[arg(long, default_value_t = 0, value_parser = crate::trials::parse_seed,
        conflicts_with_all = ["labels", "frame_labels"])]
    seed: u64,
    #[command(flatten)]
    recorded: RecordedArguments,
    /// Folder of the page.
    #[arg(short, long, value_name = "DIR", default_value = "slip")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
    #[command(flatten)]
    json: Json,
}

pub fn score_slip(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let labelled = arguments.labels.is_some() || arguments.recorded.frame_labels.is_some();
    if !labelled {
        if let Some(option) = arguments.recorded.given() {
            let message = format!("{option} is for recordings; add their LABELS or --frame-labels");
            return Err(message.into());
        }
        let source = &arguments.source;
        // A run of an experiment may have created a folder with the experiment's name.
        let built_in = BUILT_IN.iter().any(|b| b.name == source);
        if !built_in && Path::new(source).is_dir() {
            return Err(format!("{source}: a folder of recordings requires LABELS as the second argument, or --frame-labels").into());
        }
        return simulated::score(arguments, out);
    }
    recorded::score(arguments, out)
}

/// Creates the output folder.
fn make_folder(arguments: &Arguments) -> Result<(), CommandError> {
    create_folder(&arguments.out)
        .map_err(|e| format!("--out {}: {e}; expected a folder", arguments.out.display()).into())
}
