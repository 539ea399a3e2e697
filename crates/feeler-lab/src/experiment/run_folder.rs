//! Folders for runs.

use super::{ExperimentError, run_facts};
use crate::config::ExperimentConfig;
use feeler_report::make::{RECORDING, REPORT, SUMMARY, create_folder};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Why there is no folder for a run.
#[derive(Debug, thiserror::Error)]
pub enum RunFolderError {
    /// The folder has a run.
    #[error("{}: there is a run already ({found}); expected a new folder", folder.display())]
    Taken {
        /// The folder.
        folder: PathBuf,
        /// A file of the run.
        found: &'static str,
    },
    /// The folder cannot be made.
    #[error("{}: {source}; expected a new folder", folder.display())]
    Make {
        /// The folder.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// There is no recording.
    #[error(
        "{}: there is no recording; expected the folder of a run, with {RECORDING} in it, or an MCAP file",
        path.display()
    )]
    NoRecording {
        /// Where it was looked for.
        path: PathBuf,
    },
    /// The run cannot be named.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
}

/// Makes the folder `out`, unless there is a run in it already.
///
/// # Errors
/// When there is, or the folder cannot be made.
pub fn named(out: &Path) -> Result<(), RunFolderError> {
    let folder = out.to_path_buf();
    let mut names = [RECORDING, REPORT, SUMMARY].into_iter();
    if let Some(found) = names.find(|name| out.join(name).exists()) {
        return Err(RunFolderError::Taken { folder, found });
    }
    create_folder(out).map_err(|source| RunFolderError::Make { folder, source })
}

/// Makes a folder of its own in `parent` for a run of `config`, called NAME-SENSING-NUMBER or, where there is one,
/// NAME-SENSING-NUMBER-2, ...; without a `number`, by its seed.
///
/// # Errors
/// When the folder cannot be made.
pub fn new(
    parent: &Path,
    config: &ExperimentConfig,
    number: Option<String>,
) -> Result<PathBuf, RunFolderError> {
    let facts = run_facts(config)?;
    let number = number.unwrap_or_else(|| format!("seed{}", facts.seed));
    let stem = format!("{}-{}-{number}", facts.experiment, facts.sensing);
    let make = || {
        create_folder(parent)?;
        let mut folder = parent.join(&stem);
        for number in 2_u32.. {
            match std::fs::create_dir(&folder) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                    folder = parent.join(format!("{stem}-{number}"));
                }
                made => return made.map(|()| folder),
            }
        }
        Err(ErrorKind::AlreadyExists.into())
    };
    make().map_err(|source| RunFolderError::Make {
        folder: parent.join(&stem),
        source,
    })
}

/// The recording that is meant by `path`: a run's folder, or the file itself.
///
/// # Errors
/// When there is none.
pub fn recording(path: &Path) -> Result<PathBuf, RunFolderError> {
    let inside = path.join(RECORDING);
    let mut files = [inside, path.to_path_buf()].into_iter();
    files
        .find(|file| file.is_file())
        .ok_or_else(|| RunFolderError::NoRecording {
            path: path.to_path_buf(),
        })
}
