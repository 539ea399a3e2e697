//! `feeler export`

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
    /// A table in a Parquet file for each run, with a row for each control step: for pandas, Polars, PyArrow, DuckDB.
    Parquet(TableArguments),
    /// A data set of LeRobot, format v3.0: each run is an episode.
    Lerobot(DataSetArguments),
}

#[derive(Debug, clap::Args)]
struct TableArguments {
    /// The runs' folders, or recordings.
    #[arg(required = true)]
    runs: Vec<PathBuf>,
    /// A file that ends in .parquet, for one run; or a folder, for RUN.parquet of each.
    #[arg(short, long, value_name = "PATH")]
    output: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
}

#[derive(Debug, clap::Args)]
struct DataSetArguments {
    /// The runs' folders, or recordings: of the same fingers and elements, and as many control steps per second.
    #[arg(required = true)]
    runs: Vec<PathBuf>,
    /// The data set's folder.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// What the hand does, for policies that are told so in words [default: the experiment's name]
    #[arg(long, value_name = "WORDS")]
    task: Option<String>,
    /// Replace a data set that is there already. Nothing else is replaced, and no input.
    #[arg(long)]
    force: bool,
}

/// Exports runs.
#[cfg(feature = "export")]
pub fn export(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    match &arguments.format {
        Format::Parquet(arguments) => table::export(arguments, out),
        Format::Lerobot(arguments) => data_set::export(arguments, out),
    }
}

/// Says that it cannot be done.
#[cfg(not(feature = "export"))]
pub fn export(_: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    Err("export: this program was built without exports; build it with --features export".into())
}
