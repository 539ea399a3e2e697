//! `feeler score-slip`: slip detectors against the truth, the simulator's or that of labelled recordings.

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

use super::{CommandError, Outcome};
use crate::options::Json;
use crate::options::Overwrite;
use feeler_lab::config::BUILT_IN;
use feeler_report::make::create_folder;
use recorded::RecordedArguments;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Name of the page.
const PAGE: &str = "slip.html";

/// With one name, an experiment: detectors are held against the simulator's truth. With LABELS (or --frame-labels),
/// recordings of grasps: detectors are held against their labels, each with a threshold that was chosen without the
/// recordings of its own group.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// An experiment file, or the name of a built-in experiment: its fingertip of finger 0, noise and thresholds. With LABELS,
    /// recordings: a file or a folder of tables of `feeler sense`, of videos of a marker gel, or, with --taxels,
    /// of tables of taxel arrays.
    #[arg(value_name = "EXPERIMENT|RECORDINGS", default_value = "cap-closing")]
    source: String,
    /// Labels of the recordings: a table with a column `recording`, `sequence` or `video` (or else its first), a column `slip`
    /// of 0 and 1, and, where frames are labelled, a column `frame` from 0.
    labels: Option<PathBuf>,
    /// Number of trials to score in simulation; as many others choose the thresholds.
    #[arg(long, default_value_t = 1000, conflicts_with_all = ["labels", "frame_labels"],
        value_parser = clap::value_parser!(u64).range(1..=100_000))]
    trials: u64,
    /// Set any value of the experiment, as in sim.direct_sensing.shear_noise=0.005.
    #[arg(long = "set", value_name = "KEY=VALUE", conflicts_with_all = ["labels", "frame_labels"])]
    settings: Vec<String>,
    /// Random seed of the simulation.
    #[arg(long, default_value_t = 0, value_parser = crate::trials::parse_seed,
        conflicts_with_all = ["labels", "frame_labels"])]
    seed: u64,
    #[command(flatten)]
    recorded: RecordedArguments,
    /// The page's folder.
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
            let message = format!(
                "{option} is for recordings; expected their LABELS, or --frame-labels, too"
            );
            return Err(message.into());
        }
        let source = &arguments.source;
        // A run of an experiment may have left a folder of its name.
        let built_in = BUILT_IN.iter().any(|b| b.name == source);
        if !built_in && Path::new(source).is_dir() {
            return Err(format!("{source}: it is a folder of recordings; expected their LABELS behind it, or --frame-labels").into());
        }
        return simulated::score(arguments, out);
    }
    recorded::score(arguments, out)
}

/// Makes the output folder.
fn make_folder(arguments: &Arguments) -> Result<(), CommandError> {
    create_folder(&arguments.out)
        .map_err(|e| format!("--out {}: {e}; expected a folder", arguments.out.display()).into())
}
