//! Folders for runs.

use super::CommandError;
use feeler_report::make::{RECORDING, REPORT, SUMMARY};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Makes the folder that `--out` names, unless there is a run in it already.
pub fn named(out: &Path) -> Result<(), CommandError> {
    let mut names = [RECORDING, REPORT, SUMMARY].into_iter();
    if let Some(old) = names.find(|name| out.join(name).exists()) {
        let out = out.display();
        return Err(
            format!("--out {out}: there is a run already ({old}); expected a new folder").into(),
        );
    }
    let failed = |e| format!("--out {}: {e}; expected a new folder", out.display());
    Ok(std::fs::create_dir_all(out).map_err(failed)?)
}

/// Makes a folder of its own in `parent`, called `stem` or `stem-2`, `stem-3`, …
pub fn new(parent: &Path, stem: &str) -> io::Result<PathBuf> {
    std::fs::create_dir_all(parent)?;
    let mut folder = parent.join(stem);
    for number in 2.. {
        match std::fs::create_dir(&folder) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                folder = parent.join(format!("{stem}-{number}"));
            }
            made => return made.map(|()| folder),
        }
    }
    unreachable!("the numbers do not end")
}
