//! Options of `feeler score-slip`.

use std::path::PathBuf;

/// Data on which slip detectors are scored.
#[derive(Debug, Clone)]
pub struct SlipScoreOptions {
    /// Experiment (a file or a built-in name) or, with labels, recordings.
    pub source: String,
    /// Labels of the recordings.
    pub labels: Option<PathBuf>,
    /// Number of simulated trials to score.
    pub trials: u64,
    /// Settings of the experiment.
    pub settings: Vec<String>,
    /// Seed of the simulation.
    pub seed: u64,
    /// Recordings to score.
    pub recorded: RecordedOptions,
    /// Output folder of the report.
    pub out: PathBuf,
    /// `true` to replace existing outputs.
    pub force: bool,
    /// `true` to print JSON instead of text.
    pub json: bool,
}

/// Labelled recordings to score.
#[derive(Debug, Clone, Default)]
pub struct RecordedOptions {
    /// Layout of a taxel array (a file or a built-in name), if the tables contain taxels.
    pub taxels: Option<String>,
    /// Column prefix of each array, if a table contains several.
    pub prefixes: Vec<String>,
    /// Column whose value changes where the next recording begins.
    pub sequence: Option<String>,
    /// Names of the tables in each recording's folder.
    pub tables: Vec<String>,
    /// Layout of all recordings that have no layout next to them.
    pub layout: Option<PathBuf>,
    /// Rows (frames) per second, overriding any time column.
    pub rate: Option<f64>,
    /// `true` if recordings begin without contact.
    pub untouched: bool,
    /// Column of the labels that groups recordings.
    pub group: Option<String>,
    /// Name of the label table of the frames in each recording's folder.
    pub frame_labels: Option<String>,
    /// Other recordings and their labels, from which thresholds are chosen; empty or two paths.
    pub thresholds_from: Vec<PathBuf>,
}

impl RecordedOptions {
    /// Returns the first given option that requires recordings.
    pub fn given(&self) -> Option<&'static str> {
        let given = [
            ("--taxels", self.taxels.is_some()),
            ("--table", !self.tables.is_empty()),
            ("--layout", self.layout.is_some()),
            ("--rate", self.rate.is_some()),
            ("--untouched", self.untouched),
            ("--thresholds-from", !self.thresholds_from.is_empty()),
        ];
        given
            .iter()
            .find_map(|(option, given)| given.then_some(*option))
    }
}
