//! The `feeler score-slip` subcommand.

use super::{CommandError, Outcome};
use crate::options::{Json, Overwrite, parse_rate};
use feeler_sensing::{RecordedOptions, SlipScoreOptions};
use std::io::Write;
use std::path::PathBuf;

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
    #[arg(long, default_value_t = 0, value_parser = crate::experiments::trials::parse_seed,
        conflicts_with_all = ["labels", "frame_labels"])]
    seed: u64,
    #[command(flatten)]
    recorded: RecordedArguments,
    /// Output folder of the report.
    #[arg(short, long, value_name = "DIR", default_value = "slip")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
    #[command(flatten)]
    json: Json,
}

/// Options for recordings.
#[derive(Debug, Default, clap::Args)]
pub struct RecordedArguments {
    /// Read tables of a three-axis taxel array with this layout: a file or a built-in one (see `feeler list`).
    #[arg(long, value_name = "LAYOUT", conflicts_with = "layout")]
    pub taxels: Option<String>,
    /// Prefix of an array's columns if the tables have several arrays, as in left (repeatable, once for each array).
    #[arg(long = "prefix", value_name = "PREFIX", requires = "taxels")]
    pub prefixes: Vec<String>,
    /// Column whose value changes where another recording begins in the same table.
    #[arg(long, value_name = "COLUMN", requires = "taxels")]
    pub sequence: Option<String>,
    /// Name of the table in each recording's folder (repeatable, once for each array that measured the same grasp).
    #[arg(long = "table", value_name = "FILE")]
    pub tables: Vec<String>,
    /// Layout from `feeler locate` for all recordings that have none next to them (NAME.toml next to NAME.csv).
    #[arg(long, value_name = "FILE")]
    pub layout: Option<PathBuf>,
    /// Rows (frames) per second; overrides any time column.
    #[arg(long, value_name = "HZ", value_parser = parse_rate)]
    pub rate: Option<f64>,
    /// Declare that recordings start without contact, so that vectors of 0 mean no contact. Taxels detect contact only
    /// with this option.
    #[arg(long)]
    pub untouched: bool,
    /// Column of LABELS that groups recordings, for example by object [default: each recording is a group]
    #[arg(long, value_name = "COLUMN", requires = "labels")]
    pub group: Option<String>,
    /// Name of a table in each recording's folder that labels its frames: a column `slip`, one row per frame.
    #[arg(long, value_name = "FILE")]
    pub frame_labels: Option<String>,
    /// Also score with thresholds chosen on other recordings and their labels.
    ///
    /// Tables of `feeler sense`, such as those of `feeler simulate-grasps`, videos, or, with --taxels, tables of the
    /// same array in the same arrangement of files or folders as RECORDINGS.
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
