//! Atomic creation of an output folder.

use crate::CommandError;
use feeler_report::run::create_folder;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// File that identifies a folder as a data set.
const INFO: &str = "meta/info.json";

/// A data set's folder, written as `NAME.part` and renamed when complete. Dropping it earlier removes it.
pub struct NewFolder {
    part: PathBuf,
    path: PathBuf,
}

impl NewFolder {
    /// Creates the partial folder for `path` (from `--output`) of a command that reads `inputs`.
    ///
    /// # Errors
    /// If `path` exists and is not an empty folder (with `force`: not a data set), if it contains an input, or if it
    /// cannot be created.
    pub fn create<'a>(
        path: &Path,
        force: bool,
        mut inputs: impl Iterator<Item = &'a Path>,
    ) -> Result<Self, CommandError> {
        let refuse = |path: &Path, what: &str| {
            let path = path.display();
            Err(format!("--output {path}: {what}").into())
        };
        let Some(name) = path.file_name() else {
            return refuse(path, "expected the name of a folder");
        };
        // Next to `path`, even if that has a trailing slash.
        let mut part = name.to_owned();
        part.push(".part");
        let part = path.with_file_name(part);
        let is_inside = |input: &&Path| is_in(input, path) || is_in(input, &part);
        if let Some(input) = inputs.find(is_inside) {
            let input = input.display();
            return refuse(
                path,
                &format!("contains the input {input}; expected another folder"),
            );
        }
        if is_there(path) && !force {
            let what = "exists already; expected a new folder, or --force to replace a data set";
            return refuse(path, what);
        }
        if is_there(path) && !path.join(INFO).is_file() {
            let what = "is not a data set; expected a new folder, or a data set to replace";
            return refuse(path, what);
        }
        if is_there(&part) {
            if !force {
                let what = "exists already, perhaps from a killed export; remove it, or use --force to replace it";
                return refuse(&part, what);
            }
            fs::remove_dir_all(&part).map_err(|error| failed(&part, &error))?;
        }
        create_folder(&part).map_err(|error| failed(path, &error))?;
        Ok(Self {
            part,
            path: path.to_path_buf(),
        })
    }

    /// Returns the path of the partial folder.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Renames the complete folder to its final path.
    ///
    /// # Errors
    /// If an existing data set cannot be removed, or the folder cannot be renamed.
    pub fn rename(self) -> Result<(), CommandError> {
        let moved = match fs::remove_dir_all(&self.path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => fs::rename(&self.part, &self.path),
        };
        Ok(moved.map_err(|error| failed(&self.path, &error))?)
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        // The partial folder no longer exists after a rename. If removal fails, the name still marks it as partial.
        let _ = fs::remove_dir_all(&self.part);
    }
}

/// Returns `true` if `path` exists and is not an empty folder.
fn is_there(path: &Path) -> bool {
    let is_empty = || fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none());
    fs::symlink_metadata(path).is_ok() && !is_empty()
}

fn is_in(input: &Path, folder: &Path) -> bool {
    let resolved = (input.canonicalize(), folder.canonicalize());
    matches!(resolved, (Ok(input), Ok(folder)) if input.starts_with(&folder))
}

fn failed(path: &Path, error: &io::Error) -> String {
    let path = path.display();
    format!("--output {path}: {error}; expected a writable folder")
}
