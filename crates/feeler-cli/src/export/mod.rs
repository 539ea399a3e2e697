//! The `feeler export` subcommand.

#[cfg(feature = "export")]
mod data_set;
#[cfg(feature = "export")]
mod folder;
#[cfg(feature = "export")]
mod runs;
#[cfg(feature = "export")]
mod table;

use super::{CommandError, Outcome};
use crate::options::Overwrite;
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    format: Format,
}

#[derive(Debug, clap::Subcommand)]
enum Format {
    /// Write a Parquet table per run, with one row per control step, for pandas, Polars, PyArrow or DuckDB.
    Parquet(TableArguments),
    /// Write a LeRobot data set (format v3.0), with one episode per run.
    Lerobot(DataSetArguments),
}

#[derive(Debug, clap::Args)]
struct TableArguments {
    /// Folders of runs, or recordings.
    #[arg(required = true)]
    runs: Vec<PathBuf>,
    /// Output: FILE.parquet for a single run, otherwise a folder that receives RUN.parquet for each run.
    #[arg(short, long, value_name = "PATH")]
    output: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
}

#[derive(Debug, clap::Args)]
struct DataSetArguments {
    /// Folders of runs, or recordings. All must have the same fingers, elements and control rate.
    #[arg(required = true)]
    runs: Vec<PathBuf>,
    /// Output folder of the data set.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Task description for language-conditioned policies [default: the experiment's name]
    #[arg(long, value_name = "WORDS")]
    task: Option<String>,
    /// Frames per second, at most the control rate. Each frame is the control step nearest to its time [default: the
    /// control rate]
    #[arg(long, value_name = "RATE", value_parser = clap::value_parser!(u32).range(1..))]
    fps: Option<u32>,
    /// Tactile data of a frame: the latest sample, or also a window of all samples since the previous frame.
    #[arg(long, value_name = "RATE", default_value = "frame")]
    touch_rate: TouchRate,
    /// Replace an existing data set. Other folders and inputs are never replaced.
    #[arg(long)]
    force: bool,
}

/// Rate of the tactile data in a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum TouchRate {
    /// The latest sample of each frame.
    Frame,
    /// Also all samples since the previous frame, with their times.
    Native,
}

/// Runs `feeler export`.
#[cfg(feature = "export")]
pub fn export(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    match &arguments.format {
        Format::Parquet(arguments) => table::export(arguments, out),
        Format::Lerobot(arguments) => data_set::export(arguments, out),
    }
}

/// Returns an error: this build has no exports.
#[cfg(not(feature = "export"))]
pub fn export(_: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    Err("export: this program was built without exports; build it with --features export".into())
}
