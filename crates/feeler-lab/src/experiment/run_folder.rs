//! Folders of runs.

use super::{ExperimentError, run_facts};
use crate::config::ExperimentConfig;
use feeler_report::run::{RECORDING, REPORT, SUMMARY, create_folder};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Error in the creation or search of a run folder.
#[derive(Debug, thiserror::Error)]
pub enum RunFolderError {
    /// The folder already contains a run.
    #[error("{}: the folder already contains a run ({found}); expected a new folder", folder.display())]
    Taken {
        /// Path of the folder.
        folder: PathBuf,
        /// Name of the existing file of that run.
        found: &'static str,
    },
    /// The folder cannot be created.
    #[error("{}: {source}; expected a new folder", folder.display())]
    Make {
        /// Path of the folder.
        folder: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The path does not contain a recording.
    #[error(
        "{}: found no recording; expected the folder of a run, with {RECORDING} in it, or an MCAP file",
        path.display()
    )]
    NoRecording {
        /// The searched path.
        path: PathBuf,
    },
    /// The name of the run cannot be determined.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
}

/// Creates the folder `out`, unless it already contains a run.
///
/// # Errors
/// If it contains a run, or cannot be created.
pub fn named(out: &Path) -> Result<(), RunFolderError> {
    let folder = out.to_path_buf();
    let mut names = [RECORDING, REPORT, SUMMARY].into_iter();
    if let Some(found) = names.find(|name| out.join(name).exists()) {
        return Err(RunFolderError::Taken { folder, found });
    }
    create_folder(out).map_err(|source| RunFolderError::Make { folder, source })
}

/// Creates a new folder in `parent` for a run of `config`. It is called NAME-SENSING-NUMBER, or NAME-SENSING-NUMBER-2
/// and so on if that exists. The default of `number` is the seed.
///
/// # Errors
/// If the folder cannot be created.
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

/// Returns the recording in the run folder `path`, or `path` itself if it is a file.
///
/// # Errors
/// If there is no recording.
pub fn recording(path: &Path) -> Result<PathBuf, RunFolderError> {
    let inside = path.join(RECORDING);
    let mut files = [inside, path.to_path_buf()].into_iter();
    files
        .find(|file| file.is_file())
        .ok_or_else(|| RunFolderError::NoRecording {
            path: path.to_path_buf(),
        })
}
