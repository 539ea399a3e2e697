//! From a name or a file, and what the command line sets, to an experiment.

use super::check::{Problem, check};
use super::{ExperimentConfig, Sensing};
use crate::sensor::calibration::{Calibration, CalibrationError};
use std::path::{Path, PathBuf};
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// An experiment that comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltIn {
    /// The name to call it by.
    pub name: &'static str,
    /// Its file.
    pub toml: &'static str,
}

/// The experiments that come with the program.
pub const BUILT_IN: [BuiltIn; 1] = [BuiltIn {
    name: "cap-closing",
    toml: include_str!("../../experiments/cap-closing.toml"),
}];

/// The calibrations that the built-in experiments name.
const BUILT_IN_CALIBRATIONS: [(&str, &str); 1] = [(
    "reference-fingertip.calibration.toml",
    include_str!("../../experiments/reference-fingertip.calibration.toml"),
)];

/// Why an experiment cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// Neither a built-in experiment nor a file.
    #[error(
        "there is no experiment {name:?}: expected a file or one of the built-in {}",
        BUILT_IN.map(|b| b.name).join(", ")
    )]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// A file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The text is not TOML, or a key is unknown, missing or of the wrong type.
    #[error("{origin}: {message}")]
    Syntax {
        /// Where the text came from.
        origin: String,
        /// Line, column and what was expected.
        message: String,
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
    #[error("sensor.calibration = {file:?}: {source}")]
    Calibration {
        /// The file.
        file: String,
        /// What is wrong with it.
        source: CalibrationError,
    },
}

fn list(problems: &[Problem]) -> String {
    let lines = problems.iter().map(|p| format!("\n  {p}"));
    format!("out of range:{}", lines.collect::<String>())
}

/// An experiment: its configuration, and the text that says the same with all comments.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// The configuration, checked.
    pub config: ExperimentConfig,
    /// The experiment file as run, with what the command line set.
    pub toml: String,
    /// The folder that file names are relative to; none for a built-in experiment.
    folder: Option<PathBuf>,
}

impl Experiment {
    /// The experiment called `name`, a built-in one or a file, with `settings` of the form
    /// `control.slip_threshold=2.5` put in.
    ///
    /// # Errors
    /// When there is none, its text makes no sense, or a value is out of its range.
    pub fn load(name: &str, settings: &[String]) -> Result<Self, ConfigError> {
        if let Some(built_in) = BUILT_IN.iter().find(|b| b.name == name) {
            return Self::parse(built_in.toml, name, settings, None);
        }
        let path = Path::new(name);
        if !path.exists() {
            let name = name.to_string();
            return Err(ConfigError::Unknown { name });
        }
        let text = read(path)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        Self::parse(&text, name, settings, Some(folder))
    }

    /// The experiment that `text` says, which came from `origin` (for messages). File names in it
    /// are relative to `folder`; without one, they name built-in files.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn parse(
        text: &str,
        origin: &str,
        settings: &[String],
        folder: Option<PathBuf>,
    ) -> Result<Self, ConfigError> {
        let syntax = |message: String| ConfigError::Syntax {
            origin: origin.to_string(),
            message,
        };
        let mut document: DocumentMut = text
            .parse()
            .map_err(|e: toml_edit::TomlError| syntax(e.to_string()))?;
        for setting in settings {
            put(&mut document, setting)?;
        }
        let toml = document.to_string();
        let config: ExperimentConfig = toml::from_str(&toml).map_err(|e| syntax(e.to_string()))?;
        let problems = check(&config);
        if !problems.is_empty() {
            let origin = origin.to_string();
            return Err(ConfigError::OutOfRange { origin, problems });
        }
        Ok(Self {
            config,
            toml,
            folder,
        })
    }

    /// The calibration that the experiment names, if it senses through pictures.
    ///
    /// # Errors
    /// When its file cannot be read or is no calibration.
    pub fn calibration(&self) -> Result<Option<Calibration>, ConfigError> {
        if self.config.sensing == Sensing::Direct {
            return Ok(None);
        }
        let file = &self.config.sensor.calibration;
        let built_in = BUILT_IN_CALIBRATIONS.iter().find(|(name, _)| name == file);
        let text = match (&self.folder, built_in) {
            (None, Some((_, text))) => (*text).to_string(),
            (folder, _) => {
                let folder = folder.as_deref().unwrap_or(Path::new(""));
                read(&folder.join(file))?
            }
        };
        let calibration = Calibration::from_toml(&text);
        calibration
            .map(Some)
            .map_err(|source| ConfigError::Calibration {
                file: file.clone(),
                source,
            })
    }
}

fn read(path: &Path) -> Result<String, ConfigError> {
    std::fs::read_to_string(path).map_err(|source| ConfigError::Read {
        path: path.to_path_buf(),
        source,
    })
}

/// Puts `key.path=value` into a document; numbers in the path index arrays. The key must be there.
fn put(document: &mut DocumentMut, setting: &str) -> Result<(), ConfigError> {
    let error = |message: String| ConfigError::Setting {
        setting: setting.to_string(),
        message,
    };
    let (key, value) = setting
        .split_once('=')
        .ok_or_else(|| error("expected key=value, as in control.slip_threshold=2.5".into()))?;
    let mut item = document.as_item_mut();
    for part in key.trim().split('.') {
        item = step_into(item, part)
            .map_err(|known| error(format!("there is no {part:?}; expected one of {known}")))?;
    }
    let value = value.trim();
    // A word that is no TOML value is a string: --set sensing=direct needs no quotes.
    let parsed = value.parse().unwrap_or_else(|_| Value::from(value));
    let comment = item.as_value().map(|old| old.decor().clone());
    *item = Item::Value(parsed);
    if let (Some(value), Some(decor)) = (item.as_value_mut(), comment) {
        *value.decor_mut() = decor;
    }
    Ok(())
}

/// The item called `part` in a table, or at index `part` in an array of tables; otherwise what
/// there is.
fn step_into<'a>(item: &'a mut Item, part: &str) -> Result<&'a mut Item, String> {
    let known = match &*item {
        Item::ArrayOfTables(tables) => format!("0 to {}", tables.len().saturating_sub(1)),
        other => other.as_table_like().map_or("no keys".into(), keys),
    };
    let found = match part.parse::<usize>() {
        Ok(index) => item.get_mut(index),
        Err(_) => item.get_mut(part),
    };
    found.ok_or(known)
}

fn keys(table: &dyn TableLike) -> String {
    let keys: Vec<_> = table.iter().map(|(key, _)| key).collect();
    keys.join(", ")
}
