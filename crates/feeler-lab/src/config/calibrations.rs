//! The calibration files that an experiment names.

use super::error::ConfigError;
use super::load::{Experiment, read};
use feeler::sensor::calibration::Calibration;
use std::collections::BTreeMap;

/// The calibrations of these names, from their files.
macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        [$((
            concat!($name, ".calibration.toml"),
            include_str!(concat!("../../experiments/", $name, ".calibration.toml")),
        )),*]
    };
}

/// The calibrations that the built-in experiments name.
const BUILT_IN_CALIBRATIONS: [(&str, &str); 5] = built_in![
    "reference-fingertip",
    "reference-fingertip.coupled",
    "cap-closing-pins",
    "cap-closing-fibres",
    "cap-closing-gel",
];

/// The text of the calibration that built-in experiments call `name`.
pub fn built_in_calibration(name: &str) -> Option<&'static str> {
    let found = BUILT_IN_CALIBRATIONS.iter().find(|(own, _)| *own == name);
    found.map(|(_, text)| *text)
}

impl Experiment {
    /// The same experiment with these calibration files, by the name that it has for each, in place of
    /// those in its folder.
    #[must_use]
    pub fn with_calibrations(mut self, texts: BTreeMap<String, String>) -> Self {
        self.calibrations = texts;
        self
    }

    /// The calibration that the experiment names for `finger`.
    ///
    /// # Errors
    /// When its file cannot be read or is no calibration.
    pub fn calibration(&self, finger: usize) -> Result<Calibration, ConfigError> {
        let (file, key) = self.config.sensor.calibration(finger);
        let text = self.calibration_text(finger)?;
        Calibration::from_toml(&text).map_err(|source| ConfigError::Calibration {
            key,
            file: file.to_string(),
            source: Box::new(source),
        })
    }

    /// The text of every calibration file that the experiment names, by the name that it has for it.
    ///
    /// # Errors
    /// When one cannot be read.
    pub fn calibration_texts(&self) -> Result<BTreeMap<String, String>, ConfigError> {
        let fingers = 0..self.config.hand.finger.len();
        fingers
            .map(|finger| {
                let (file, _) = self.config.sensor.calibration(finger);
                Ok((file.to_string(), self.calibration_text(finger)?))
            })
            .collect()
    }

    fn calibration_text(&self, finger: usize) -> Result<String, ConfigError> {
        let (file, key) = self.config.sensor.calibration(finger);
        if let Some(text) = self.calibrations.get(file) {
            return Ok(text.clone());
        }
        if let (None, Some(text)) = (&self.folder, built_in_calibration(file)) {
            return Ok(text.to_string());
        }
        read(&self.folder().join(file), "a calibration file").map_err(|source| {
            ConfigError::CalibrationFile {
                key,
                file: file.to_string(),
                source: Box::new(source),
            }
        })
    }
}
