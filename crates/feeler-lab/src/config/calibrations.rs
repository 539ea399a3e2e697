//! The calibration files that an experiment refers to.

use super::error::ConfigError;
use super::load::Experiment;
use super::read::read;
use feeler::sensor::calibration::Calibration;
use std::collections::BTreeMap;

/// Builds the array of calibrations with the given names from their files.
macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        [$((
            concat!($name, ".calibration.toml"),
            include_str!(concat!("../../experiments/", $name, ".calibration.toml")),
        )),*]
    };
}

/// Calibrations used by the built-in experiments: file name and text.
const BUILT_IN_CALIBRATIONS: [(&str, &str); 5] = built_in![
    "reference-fingertip",
    "reference-fingertip.coupled",
    "cap-closing-pins",
    "cap-closing-fibres",
    "cap-closing-gel",
];

/// Returns the text of the built-in calibration `name`, or `None` if there is no such calibration.
pub fn built_in_calibration(name: &str) -> Option<&'static str> {
    let found = BUILT_IN_CALIBRATIONS.iter().find(|(own, _)| *own == name);
    found.map(|(_, text)| *text)
}

impl Experiment {
    /// Replaces the calibration files in the experiment's folder by the given `texts`, keyed by the file name used in
    /// the experiment.
    #[must_use]
    pub fn with_calibrations(mut self, texts: BTreeMap<String, String>) -> Self {
        self.calibrations = texts;
        self
    }

    /// Loads the calibration of `finger`.
    ///
    /// # Errors
    /// If the file cannot be read or is not a valid calibration.
    pub fn calibration(&self, finger: usize) -> Result<Calibration, ConfigError> {
        let (file, key) = self.config.sensor.calibration(finger);
        let text = self.calibration_text(finger)?;
        Calibration::from_toml(&text).map_err(|source| ConfigError::Calibration {
            key,
            file: file.to_string(),
            source: Box::new(source),
        })
    }

    /// Returns the text of each calibration file, keyed by the file name used in the experiment.
    ///
    /// # Errors
    /// If a file cannot be read.
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
