//! Collects the input files of a sweep's trials, for transfer to other machines.

use crate::config::key::leaves;
use crate::config::{Experiment, Sensing, built_in_calibration};
use crate::sweep::SweepError;
use crate::sweep::plan::parameter::settings;
use crate::sweep::plan::plan_file::Plan;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Contents of files, keyed by the file name used in the experiment.
pub type Files = BTreeMap<String, Vec<u8>>;

/// Last segment of the configuration keys that name calibration files. Keys that name other files end with [`FILE`].
const CALIBRATION: &str = "calibration";
const FILE: &str = "file";

impl Plan {
    /// Reads all files that a trial may need: those that the experiment refers to, and those that may be drawn.
    ///
    /// # Errors
    /// If the plan is invalid, or a file is missing or outside of the experiment's folder.
    pub fn files(&self) -> Result<Files, SweepError> {
        let (experiment, parameters) = self.load()?;
        let mut files = Files::new();
        self.collect(&experiment, &mut files)?;
        for parameter in &parameters {
            for value in parameter.distribution.extremes(parameter.whole) {
                let drawn = settings([(parameter, &value)])?;
                let (text, folder) = (&self.experiment, self.folder.clone());
                let experiment = Experiment::parse(text, &self.origin, &drawn, folder)?;
                self.collect(&experiment, &mut files)?;
            }
        }
        Ok(files)
    }

    /// Returns the plan with file names relative to `folder`, which must contain all [`files`](Self::files).
    #[must_use]
    pub fn with_folder(mut self, folder: PathBuf) -> Self {
        self.folder = Some(folder);
        self
    }

    /// Reads the files of `experiment` that are not in `files` yet.
    fn collect(&self, experiment: &Experiment, files: &mut Files) -> Result<(), SweepError> {
        for (key, value) in leaves(&experiment.config) {
            let kind = key.rsplit('.').next().unwrap_or_default();
            let Some(name) = value
                .as_str()
                .filter(|_| [CALIBRATION, FILE].contains(&kind))
            else {
                continue;
            };
            if files.contains_key(name) {
                continue;
            }
            let built_in = self.folder.is_none().then(|| built_in_calibration(name));
            if let Some(text) = built_in.flatten() {
                files.insert(name.to_string(), text.into());
                continue;
            }
            // Directly sensed forces need no calibration.
            let optional = kind == CALIBRATION && experiment.config.sensing == Sensing::Direct;
            let path = experiment.folder().join(name);
            if !optional || path.exists() {
                files.insert(name.to_string(), read(&key, name, &path)?);
            }
        }
        Ok(())
    }
}

/// Reads the file `name`, which is the value of `key`.
fn read(key: &str, name: &str, path: &Path) -> Result<Vec<u8>, SweepError> {
    let inside = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    if !Path::new(name).components().all(inside) {
        return Err(SweepError::Folder {
            path: path.to_path_buf(),
            message: format!(
                "{key} = {name:?} cannot be sent to other machines; expected a file in the experiment's folder or below"
            ),
        });
    }
    let note = format!("{key} refers to this file, and other machines need it");
    fs::read(path).map_err(SweepError::file(path, note))
}
