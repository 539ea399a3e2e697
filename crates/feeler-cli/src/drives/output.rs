//! The experiment file that a command writes with new values of `[drives]`.

use super::RigArguments;
use crate::CommandError;
use crate::options::Overwrite;
use feeler_console::{Outputs, PartFile};
use feeler_rig::ServoRig;
use std::io::Write;
use std::path::{Path, PathBuf};

/// A new experiment file.
pub(super) struct NewExperiment<'a> {
    file: PartFile,
    path: &'a Path,
}

impl<'a> NewExperiment<'a> {
    /// Creates the file of `--output`. `None` without `--output`, or with `--dry-run`.
    pub fn create(
        path: &'a Option<PathBuf>,
        rig: &RigArguments,
        overwrite: &Overwrite,
    ) -> Result<Option<Self>, CommandError> {
        let Some(path) = path.as_deref().filter(|_| !rig.dry_run) else {
            return Ok(None);
        };
        let inputs = [Some(Path::new(&rig.experiment))];
        let file = Outputs::new(overwrite.force, inputs).create(path, "--output")?;
        Ok(Some(Self { file, path }))
    }

    /// Writes the experiment of `rig` with `settings`, and prints the path.
    pub fn write(
        self,
        rig: &ServoRig,
        settings: &[String],
        out: &mut dyn Write,
    ) -> Result<(), CommandError> {
        let changed = rig.experiment.with_settings(settings)?;
        self.file.finish(changed.toml.as_bytes())?;
        Ok(writeln!(out, "{}", self.path.display())?)
    }
}
