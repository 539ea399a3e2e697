//! `feeler score-slip`

use super::{CommandError, Outcome};
use crate::options::{Json, Overwrite, parse_rate};
use feeler_sensing::{RecordedOptions, SlipScoreOptions};
use std::io::Write;
use std::path::PathBuf;

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

/// What is said of recordings.
#[derive(Debug, Default, clap::Args)]
pub struct RecordedArguments {
    /// The tables are of a three-axis taxel array, of this layout: a file, or a built-in one (`feeler list`).
    #[arg(long, value_name = "LAYOUT", conflicts_with = "layout")]
    pub taxels: Option<String>,
    /// What the columns of an array begin with, where a table has several, as in left; again for each array.
    #[arg(long = "prefix", value_name = "PREFIX", requires = "taxels")]
    pub prefixes: Vec<String>,
    /// Column whose value changes where another recording begins in the same table.
    #[arg(long, value_name = "COLUMN", requires = "taxels")]
    pub sequence: Option<String>,
    /// Each recording is a folder with a table of this name; again for each array that felt the same grasp.
    #[arg(long = "table", value_name = "FILE")]
    pub tables: Vec<String>,
    /// Layout of `feeler locate` of all recordings that have none beside them (NAME.toml beside NAME.csv).
    #[arg(long, value_name = "FILE")]
    pub layout: Option<PathBuf>,
    /// Rows (frames) per second, before any column of the time.
    #[arg(long, value_name = "HZ", value_parser = parse_rate)]
    pub rate: Option<f64>,
    /// Where vectors are 0, nothing touches: recordings begin untouched. Only then is contact known of taxels.
    #[arg(long)]
    pub untouched: bool,
    /// Column of LABELS that groups recordings, as by their object; without it, each is a group.
    #[arg(long, value_name = "COLUMN", requires = "labels")]
    pub group: Option<String>,
    /// Frames are labelled: in each recording's folder, a table of this name has a column `slip`, a row for each frame.
    #[arg(long, value_name = "FILE")]
    pub frame_labels: Option<String>,
    /// Judge with thresholds of other recordings, too, and their labels: tables of `feeler sense`, as those of `feeler
    /// simulate-grasps`, videos, or, with --taxels, tables of the same array in files or folders as those of RECORDINGS.
    #[arg(long, num_args = 2, value_names = ["RECORDINGS", "LABELS"])]
    pub thresholds_from: Vec<PathBuf>,
}

/// Scores slip detectors.
pub fn score_slip(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let recorded = &arguments.recorded;
    let options = SlipScoreOptions {
        source: arguments.source.clone(),
        labels: arguments.labels.clone(),
        trials: arguments.trials,
        settings: arguments.settings.clone(),
        seed: arguments.seed,
        recorded: RecordedOptions {
            taxels: recorded.taxels.clone(),
            prefixes: recorded.prefixes.clone(),
            sequence: recorded.sequence.clone(),
            tables: recorded.tables.clone(),
            layout: recorded.layout.clone(),
            rate: recorded.rate,
            untouched: recorded.untouched,
            group: recorded.group.clone(),
            frame_labels: recorded.frame_labels.clone(),
            thresholds_from: recorded.thresholds_from.clone(),
        },
        out: arguments.out.clone(),
        force: arguments.overwrite.force,
        json: arguments.json.json,
    };
    feeler_sensing::score_slip(&options, out)
}
