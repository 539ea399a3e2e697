//! Errors of experiment files and of the files that they refer to.

use super::built_in::BUILT_IN;
use super::key::did_you_mean;
use feeler::check::Problem;
use feeler::control::law::policy::PolicyError;
use feeler::sensor::calibration::CalibrationError;
use std::path::PathBuf;

/// Error of an experiment that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The name is neither a built-in experiment nor a file.
    #[error(
        "there is no experiment {name:?}: expected a file or one of the built-in {}{}",
        BUILT_IN.map(|b| b.name).join(", "),
        did_you_mean(name, BUILT_IN.iter().map(|b| b.name))
    )]
    Unknown {
        /// The requested name.
        name: String,
    },
    /// The finger index is out of range.
    #[error("there is no finger {finger}: expected 0 to {}", fingers - 1)]
    NoFinger {
        /// The requested index.
        finger: usize,
        /// Number of fingers.
        fingers: usize,
    },
    /// A file cannot be read.
    #[error("{}: {source}; expected {expected}", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Expected content of the file.
        expected: &'static str,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The calibration file cannot be read.
    #[error(
        "{key} = {file:?}: {source}: copy it there, or make one with \
         `feeler calibrate`"
    )]
    CalibrationFile {
        /// The key that contains the file name.
        key: String,
        /// The file name used in the experiment.
        file: String,
        /// Cause of the failure, which contains the path of the file.
        source: Box<ConfigError>,
    },
    /// A finger cannot be read from its URDF file.
    #[error("{key}: {message}")]
    Urdf {
        /// Key of the finger.
        key: String,
        /// Expected and actual content.
        message: String,
    },
    /// The text is not valid TOML, or a key is unknown, missing or of the wrong type.
    #[error("{origin}: {message}")]
    Syntax {
        /// Source of the text.
        origin: String,
        /// Position in the text, and the expected value.
        message: String,
    },
    /// Required keys are missing.
    #[error("{origin}: {} missing: {}; expected as in a file that `feeler init` writes", keys.len(), keys.join(", "))]
    Missing {
        /// Source of the text.
        origin: String,
        /// The missing keys that could be determined.
        keys: Vec<String>,
    },
    /// A simulation was requested for an experiment that describes a real rig.
    #[error(
        "{name}: the experiment has no [sim], so there is nothing to simulate; expected one with a simulated \
         world, or `feeler hand` for a real rig"
    )]
    NoSimulation {
        /// Name of the experiment.
        name: String,
    },
    /// A setting from the command line is invalid.
    #[error("--set {setting}: {message}")]
    Setting {
        /// The setting.
        setting: String,
        /// Description of the error.
        message: String,
    },
    /// Values are out of range.
    #[error("{origin}: {}", list(problems))]
    OutOfRange {
        /// Source of the text.
        origin: String,
        /// All values that are out of range.
        problems: Vec<Problem>,
    },
    /// The calibration file is invalid.
    #[error("{key} = {file:?}: {source}")]
    Calibration {
        /// The key that contains the file name.
        key: String,
        /// The file name used in the experiment.
        file: String,
        /// Error of the calibration.
        source: Box<CalibrationError>,
    },
    /// The policy file cannot be read.
    #[error("control.law.policy.file = {file:?}: {source}")]
    PolicyFile {
        /// The file name used in the experiment.
        file: String,
        /// Cause of the failure, which contains the path of the file.
        source: Box<ConfigError>,
    },
    /// The policy file is invalid.
    #[error("control.law.policy.file = {file:?}: {source}")]
    Policy {
        /// The file name used in the experiment.
        file: String,
        /// Error of the policy.
        source: Box<PolicyError>,
    },
}

fn list(problems: &[Problem]) -> String {
    let lines = problems.iter().map(|p| format!("\n  {p}"));
    format!("out of range:{}", lines.collect::<String>())
}
