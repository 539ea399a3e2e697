//! Options of `feeler league`.

use std::path::PathBuf;
use std::time::Duration;

/// Data sets and entries of a league.
#[derive(Debug, Clone)]
pub struct LeagueOptions {
    /// Folder with the data sets.
    pub data: PathBuf,
    /// Names of the data sets to use; all if empty.
    pub sets: Vec<String>,
    /// Name and command of each program to score.
    pub programs: Vec<(String, String)>,
    /// Time limit of a program for each data set.
    pub limit: Duration,
    /// Folder of the results.
    pub out: PathBuf,
    /// `true` to replace existing outputs.
    pub force: bool,
    /// `true` to print JSON instead of text.
    pub json: bool,
}
