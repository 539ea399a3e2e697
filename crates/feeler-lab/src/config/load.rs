//! Loads an experiment from a built-in name or a file and applies settings from the command line.

use super::blame::{Diagnosis, diagnose_settings};
use super::built_in::BUILT_IN;
use super::check::check;
use super::error::ConfigError;
use super::experiment_config::ExperimentConfig;
use super::missing::missing;
use super::read::read;
use super::settings::{put, with_defaults};
use super::urdf::resolve;
use super::words::in_words;
use crate::sweep::plan::plausible::plausible_hand;
use feeler::sensor::fingertip::{FingertipConfig, sha256};
use feeler_record::PolicyFile;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml_edit::DocumentMut;

/// An experiment: its checked configuration, and the equivalent text with comments.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// The checked configuration.
    pub config: ExperimentConfig,
    /// Text of the experiment file with all settings applied.
    pub toml: String,
    /// Folder that file names are relative to. `None` for a built-in experiment.
    pub(super) folder: Option<PathBuf>,
    /// Calibration files that replace those in the folder, keyed by the file name used in the experiment.
    pub(super) calibrations: BTreeMap<String, String>,
    /// Policy file that replaces the one in the folder.
    pub(super) policy: Option<PolicyFile>,
}

impl Experiment {
    /// Loads the built-in experiment or file `name` and applies `settings` of the form `control.slip_threshold=2.5`.
    ///
    /// # Errors
    /// If there is no such experiment, its text is invalid, or a value is out of range.
    pub fn load(name: &str, settings: &[String]) -> Result<Self, ConfigError> {
        if let Some(built_in) = BUILT_IN.iter().find(|b| b.name == name) {
            return Self::parse(built_in.toml, name, settings, None);
        }
        let path = Path::new(name);
        if !path.exists() {
            let name = name.to_string();
            return Err(ConfigError::Unknown { name });
        }
        let text = read(path, "the text of an experiment (TOML)")?;
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        Self::parse(&text, name, settings, Some(folder))
    }

    /// Parses the experiment in `text`. `origin` names the source in error messages. File names in the experiment are
    /// relative to `folder`; without a folder, they refer to built-in files.
    ///
    /// # Errors
    /// Same as [`Self::load`].
    pub fn parse(
        text: &str,
        origin: &str,
        settings: &[String],
        folder: Option<PathBuf>,
    ) -> Result<Self, ConfigError> {
        let syntax = |message: String| ConfigError::Syntax {
            origin: origin.to_string(),
            message: message.trim_end().to_string(),
        };
        let mut document: DocumentMut = text
            .parse()
            .map_err(|e: toml_edit::TomlError| syntax(e.to_string()))?;
        let resolved = resolve(&mut document, folder.as_deref())?.then(|| document.to_string());
        let text = resolved.as_deref().unwrap_or(text);
        let full = with_defaults(text, settings);
        for setting in settings {
            put(&mut document, full.as_ref(), setting)?;
        }
        resolve(&mut document, folder.as_deref())?;
        let toml = document.to_string();
        let config: ExperimentConfig = match toml::from_str(&toml) {
            Ok(config) => config,
            Err(e) => {
                return match diagnose_settings(text, settings) {
                    Some(Diagnosis::Meant(settings)) => {
                        Self::parse(text, origin, &settings, folder)
                    }
                    Some(Diagnosis::Wrong(error)) => Err(error),
                    None => Err(match missing_keys(&toml, &e) {
                        keys if keys.is_empty() => syntax(in_words(&e.to_string())),
                        keys => ConfigError::Missing {
                            origin: origin.to_string(),
                            keys,
                        },
                    }),
                };
            }
        };
        let problems = check(&config);
        if !problems.is_empty() {
            let origin = origin.to_string();
            return Err(ConfigError::OutOfRange { origin, problems });
        }
        let experiment = Self {
            config,
            toml,
            folder,
            calibrations: BTreeMap::new(),
            policy: None,
        };
        match experiment.redrawn_hand()? {
            None => Ok(experiment),
            // Explicit settings override drawn values, except for the seed of the drawn hand.
            Some(drawn) => {
                let seed = format!("plausible_hand={}", experiment.config.seed);
                let settings = [&drawn[..], settings, &[seed]].concat();
                Self::parse(&experiment.toml, origin, &settings, experiment.folder)
            }
        }
    }

    /// Returns the settings of the plausible hand drawn with the experiment's seed, or `None` if the experiment has no
    /// `plausible_hand` or already contains the settings for this seed.
    fn redrawn_hand(&self) -> Result<Option<Vec<String>>, ConfigError> {
        // TOML integers are signed.
        let seed = self.config.seed as i64;
        if self.config.plausible_hand.is_none_or(|drawn| drawn == seed) {
            return Ok(None);
        }
        let drawn = plausible_hand(self, self.config.seed);
        let settings = drawn.map_err(|error| ConfigError::Setting {
            setting: format!("plausible_hand={seed}"),
            message: error.to_string(),
        })?;
        Ok(Some(settings))
    }

    /// Returns the experiment with additional `settings` applied.
    ///
    /// # Errors
    /// If a setting is invalid, or a value is out of range.
    pub fn with_settings(&self, settings: &[String]) -> Result<Self, ConfigError> {
        let (origin, folder) = (&self.config.name, self.folder.clone());
        let (calibrations, policy) = (self.calibrations.clone(), self.policy.clone());
        let experiment = Self::parse(&self.toml, origin, settings, folder)?;
        Ok(Self {
            calibrations,
            policy,
            ..experiment
        })
    }

    /// Returns the experiment with its values replaced by `config`. The new text has no comments.
    ///
    /// # Errors
    /// If a value is out of range.
    pub fn with_config(&self, config: ExperimentConfig) -> Result<Self, ConfigError> {
        let problems = check(&config);
        if !problems.is_empty() {
            let origin = config.name;
            return Err(ConfigError::OutOfRange { origin, problems });
        }
        Ok(Self {
            toml: toml::to_string(&config).unwrap_or_else(|e| e.to_string()),
            config,
            ..self.clone()
        })
    }

    /// Returns the SHA-256 of all values, settings included. Comments, order and layout of the text do not affect it.
    pub fn sha256(&self) -> String {
        // Every value came from TOML, or has a TOML equivalent.
        sha256(&toml::to_string(&self.config).unwrap_or_else(|e| e.to_string()))
    }

    /// Returns the folder that file names are relative to.
    pub fn folder(&self) -> &Path {
        self.folder.as_deref().unwrap_or(Path::new(""))
    }

    /// Returns the fingertip of `finger`, or the default fingertip if `finger` is `None`.
    ///
    /// # Errors
    /// If there is no such finger.
    pub fn fingertip(&self, finger: Option<usize>) -> Result<&FingertipConfig, ConfigError> {
        let (sensor, fingers) = (&self.config.sensor, self.config.hand.finger.len());
        match finger {
            None => Ok(&sensor.fingertip),
            Some(finger) if finger < fingers => Ok(sensor.fingertip(finger)),
            Some(finger) => Err(ConfigError::NoFinger { finger, fingers }),
        }
    }
}

/// Returns the keys that `toml` lacks if the parser stopped at a missing key, else an empty list.
fn missing_keys(toml: &str, error: &toml::de::Error) -> Vec<String> {
    if !error.message().starts_with("missing field") {
        return Vec::new();
    }
    let table = toml.parse().unwrap_or_default();
    missing::<ExperimentConfig>(table)
}
