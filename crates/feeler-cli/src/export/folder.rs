//! A folder that is written beside its place.

use crate::CommandError;
use feeler_report::make::create_folder;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// What every data set has.
const INFO: &str = "meta/info.json";

/// The folder of a data set, which is written as `NAME.part` and renamed when it is whole. Dropped before, it is removed.
pub struct NewFolder {
    part: PathBuf,
    path: PathBuf,
}

impl NewFolder {
    /// Begins the folder that `--output` says is to be at `path`, of a command that reads `inputs`.
    ///
    /// # Errors
    /// When something else than an empty folder is there without `force`, or with `force` something else than a data set;
    /// when an input is in it, or it cannot be made.
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
        // Beside it, whether or not it is written with a slash at its end.
        let mut part = name.to_owned();
        part.push(".part");
        let part = path.with_file_name(part);
        let is_inside = |input: &&Path| is_in(input, path) || is_in(input, &part);
        if let Some(input) = inputs.find(is_inside) {
            let input = input.display();
            return refuse(
                path,
                &format!("the input {input} is in it; expected another folder"),
            );
        }
        if is_there(path) && !force {
            let what = "exists already; expected a new folder, or --force to replace a data set";
            return refuse(path, what);
        }
        if is_there(path) && !path.join(INFO).is_file() {
            let what = "is no data set; expected a new folder, or a data set to replace";
            return refuse(path, what);
        }
        if is_there(&part) {
            if !force {
                let what = "exists already, as of an export that was killed; expected none, or --force to replace it";
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

    /// Where it is until it is whole.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Moves it to its place, now that it is whole.
    ///
    /// # Errors
    /// When it cannot be moved, or what it replaces cannot be removed.
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
        // It is not there once it was moved. Should it not go, its name still says that it is partial.
        let _ = fs::remove_dir_all(&self.part);
    }
}

/// Whether something is there, other than an empty folder.
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
    format!("--output {path}: {error}; expected a folder that can be written to")
}
