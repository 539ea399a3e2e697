//! Finds the setting that makes a valid experiment invalid, and suggests the key that was probably intended.

use super::error::ConfigError;
use super::experiment_config::ExperimentConfig;
use super::key::{find, leaves};
use super::settings::{put, with_defaults};
use super::words::in_words;
use toml_edit::DocumentMut;

/// Diagnosis of settings that make a valid experiment invalid.
pub(super) enum Diagnosis {
    /// Corrected settings: the first abbreviated key is replaced by its full path.
    Meant(Vec<String>),
    /// The first invalid setting and its error.
    Wrong(ConfigError),
}

/// Finds the first of `settings` that makes a valid `text` invalid. Returns `None` if the text itself is invalid.
pub(super) fn diagnose_settings(text: &str, settings: &[String]) -> Option<Diagnosis> {
    let config = toml::from_str::<ExperimentConfig>(text).ok()?;
    let mut document: DocumentMut = text.parse().ok()?;
    let full = with_defaults(text, settings);
    settings.iter().enumerate().find_map(|(place, setting)| {
        if let Err(error) = put(&mut document, full.as_ref(), setting) {
            return Some(Diagnosis::Wrong(error));
        }
        let read = toml::from_str::<ExperimentConfig>(&document.to_string());
        let message = in_words(read.err()?.message());
        let wrong = |message| {
            let setting = setting.clone();
            Some(Diagnosis::Wrong(ConfigError::Setting { setting, message }))
        };
        let (name, value) = setting.split_once('=')?;
        let name = name.trim();
        let Some(unknown) = message.strip_prefix("unknown field `") else {
            return wrong(message);
        };
        // For a key with several segments, the parser reports only the first one as unknown.
        let first = name.split('.').next().unwrap_or(name).trim();
        let is_part = unknown.starts_with(&format!("{first}`"));
        match find(name, &leaves(&config)) {
            Ok((key, _)) if is_part => {
                let mut meant = settings.to_vec();
                meant[place] = format!("{key}={value}");
                Some(Diagnosis::Meant(meant))
            }
            Ok((key, _)) => wrong(format!("{message}; {key} is a key")),
            Err(suggestion) => wrong(format!("{message}; {suggestion}")),
        }
    })
}
