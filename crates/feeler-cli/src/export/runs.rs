//! Runs to export.

use crate::CommandError;
use feeler_console::Working;
use feeler_lab::experiment::run_folder;
use feeler_record::Recording;
use feeler_report::run::RECORDING;
use std::path::{Path, PathBuf};

/// A run to export.
pub struct Run {
    /// Name of the run's folder, or of the file if it is not called `recording.mcap`.
    pub name: String,
    /// Path of the recording.
    pub path: PathBuf,
}

impl Run {
    /// Finds the run at `path`.
    fn find(path: &Path) -> Result<Self, CommandError> {
        let recording = run_folder::recording(path)?;
        let named = |path: &Path| Some(path.file_name()?.to_string_lossy().into_owned());
        let name = if recording.ends_with(RECORDING) {
            let recording = recording.canonicalize()?;
            recording.parent().and_then(named)
        } else {
            named(&recording.with_extension(""))
        };
        Ok(Self {
            name: name.unwrap_or_else(|| "run".into()),
            path: recording,
        })
    }

    /// Finds the runs at `paths`.
    pub fn find_all(paths: &[PathBuf]) -> Result<Vec<Self>, CommandError> {
        paths.iter().map(|path| Self::find(path)).collect()
    }

    /// Reads the recording.
    pub fn read(&self) -> Result<Recording, CommandError> {
        let _reading = Working::on("reading the recording");
        Ok(Recording::read(&self.path)?)
    }
}
