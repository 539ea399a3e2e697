//! The `feeler league` subcommand: scores detectors, calibrations and programs on data sets.

use super::{CommandError, Outcome};
use crate::options::{Json, Overwrite};
use feeler_sensing::LeagueOptions;
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

/// Compare slip detectors, calibrations and your own programs on published recordings.
///
/// Scores the paper's rule, feeler's detectors and calibrations, simple baselines and programs on every data set found
/// in DATA, with fixed splits into training and test data. Data sets are built in or defined by files *.league.toml in
/// DATA and its subfolders. Nothing is downloaded. Writes league.html and league.csv.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder with the data sets, each in a subfolder.
    data: PathBuf,
    /// Name of a data set to use (repeatable) [default: all]
    #[arg(long = "set", value_name = "NAME")]
    sets: Vec<String>,
    /// Also score a program, as in mine='python my.py' (repeatable).
    ///
    /// The program reads recordings on standard input and answers on standard output, one JSON object per line. It is
    /// started once for each fold of each set.
    #[arg(long = "entry", value_name = "NAME=COMMAND", value_parser = parse_entry)]
    entries: Vec<(String, String)>,
    /// Time limit of each program for each data set (s).
    #[arg(long, value_name = "SECONDS", default_value_t = 300, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    time_limit: u64,
    /// Folder of the page and the table.
    #[arg(short, long, value_name = "DIR", default_value = "league")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
    #[command(flatten)]
    json: Json,
}

fn parse_entry(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, command)) if !name.trim().is_empty() && !command.trim().is_empty() => {
            Ok((name.trim().into(), command.into()))
        }
        _ => Err("expected a name and a command, as in mine='python my.py'".into()),
    }
}

/// Scores all entries on all data sets.
pub fn league(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let options = LeagueOptions {
        data: arguments.data.clone(),
        sets: arguments.sets.clone(),
        programs: arguments.entries.clone(),
        limit: Duration::from_secs(arguments.time_limit),
        out: arguments.out.clone(),
        force: arguments.overwrite.force,
        json: arguments.json.json,
    };
    feeler_sensing::league(&options, out)
}
