//! Why an experiment cannot be used.

use super::built_in::BUILT_IN;
use super::key::did_you_mean;
use feeler::check::Problem;
use feeler::control::law::policy::PolicyError;
use feeler::sensor::calibration::CalibrationError;
use std::path::PathBuf;

/// Why an experiment cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// Neither a built-in experiment nor a file.
    #[error(
        "there is no experiment {name:?}: expected a file or one of the built-in {}{}",
        BUILT_IN.map(|b| b.name).join(", "),
        did_you_mean(name, BUILT_IN.iter().map(|b| b.name))
    )]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// There is no such finger.
    #[error("there is no finger {finger}: expected 0 to {}", fingers - 1)]
    NoFinger {
        /// The finger.
        finger: usize,
        /// How many there are.
        fingers: usize,
    },
    /// A file could not be read.
    #[error("{}: {source}; expected {expected}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What it should be.
        expected: &'static str,
        /// What the system said.
        source: std::io::Error,
    },
    /// The calibration file could not be read.
    #[error(
        "{key} = {file:?}: {source}: copy it there, or make one with \
         `feeler calibrate`"
    )]
    CalibrationFile {
        /// The key that names it.
        key: String,
        /// The file, as the experiment names it.
        file: String,
        /// Where it was looked for, and what the system said.
        source: Box<ConfigError>,
    },
    /// The text is not TOML, or a key is unknown, missing or of the wrong type.
    #[error("{origin}: {message}")]
    Syntax {
        /// Where the text came from.
        origin: String,
        /// Line, column and what was expected.
        message: String,
    },
    /// Keys that have no default are not there.
    #[error("{origin}: {} missing: {}; expected as in a file that `feeler init` writes", keys.len(), keys.join(", "))]
    Missing {
        /// Where the text came from.
        origin: String,
        /// The keys, as far as they can be told.
        keys: Vec<String>,
    },
    /// The experiment is for a real rig, and a simulated one is needed.
    #[error(
        "{name}: the experiment has no [sim], so there is nothing to simulate; expected one with a simulated \
         world, or `feeler hand` for a real rig"
    )]
    NoSimulation {
        /// Name of the experiment.
        name: String,
    },
    /// A setting from the command line makes no sense.
    #[error("--set {setting}: {message}")]
    Setting {
        /// The setting.
        setting: String,
        /// What is wrong with it.
        message: String,
    },
    /// Values are out of their ranges.
    #[error("{origin}: {}", list(problems))]
    OutOfRange {
        /// Where the text came from.
        origin: String,
        /// Every value that is out of its range.
        problems: Vec<Problem>,
    },
    /// The calibration file cannot be used.
    #[error("{key} = {file:?}: {source}")]
    Calibration {
        /// The key that names it.
        key: String,
        /// The file.
        file: String,
        /// What is wrong with it.
        source: Box<CalibrationError>,
    },
    /// The policy's file could not be read.
    #[error("control.law.policy.file = {file:?}: {source}")]
    PolicyFile {
        /// The file, as the experiment names it.
        file: String,
        /// Where it was looked for, and what the system said.
        source: Box<ConfigError>,
    },
    /// The policy's file cannot be used.
    #[error("control.law.policy.file = {file:?}: {source}")]
    Policy {
        /// The file.
        file: String,
        /// What is wrong with it.
        source: Box<PolicyError>,
    },
}

fn list(problems: &[Problem]) -> String {
    let lines = problems.iter().map(|p| format!("\n  {p}"));
    format!("out of range:{}", lines.collect::<String>())
}
