//! Output files that are there whole or not at all.

use super::CommandError;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file written aside and moved when it is whole; what is left of it otherwise is removed.
pub struct PartFile {
    file: File,
    part: PathBuf,
    path: PathBuf,
    argument: &'static str,
}

impl PartFile {
    /// Begins the file that the command line's `argument` says is to be at `path`.
    pub fn create(path: &Path, argument: &'static str) -> Result<Self, CommandError> {
        // Moving a file over a device or a link would replace it.
        if fs::symlink_metadata(path).is_ok_and(|there| !there.is_file()) {
            let path = path.display();
            let message =
                format!("{argument} {path}: not a file; expected a file, new or to replace");
            return Err(message.into());
        }
        let mut part = path.as_os_str().to_owned();
        part.push(".part");
        let part = PathBuf::from(part);
        let file = File::create(&part).map_err(|e| failed(path, argument, &e))?;
        Ok(Self {
            file,
            part,
            path: path.to_owned(),
            argument,
        })
    }

    /// Writes all of it and moves it to its place.
    pub fn finish(&mut self, bytes: &[u8]) -> Result<(), CommandError> {
        let written = self.file.write_all(bytes);
        let moved = written.and_then(|()| fs::rename(&self.part, &self.path));
        moved.map_err(|e| failed(&self.path, self.argument, &e).into())
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        // After finishing there is none; otherwise it is of no use to anyone.
        let _ = fs::remove_file(&self.part);
    }
}

fn failed(path: &Path, argument: &str, error: &io::Error) -> String {
    let path = path.display();
    format!("{argument} {path}: {error}; expected a file in a folder that can be written to")
}
