//! Access to the files of certificates.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Error of reading or writing a file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", path.display())]
pub struct FileError {
    /// Path of the file.
    pub path: PathBuf,
    /// Error of the operating system.
    pub source: io::Error,
}

impl FileError {
    /// Returns a function that adds `path` to an error of the operating system.
    pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| Self { path, source }
    }
}

/// Reads a file as text. The text is empty if the file does not exist.
pub(crate) fn read_if_present(path: &Path) -> Result<String, FileError> {
    match fs::read_to_string(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(String::new()),
        read => read.map_err(FileError::at(path)),
    }
}

/// Appends to a file, creating it if it does not exist.
#[cfg(feature = "zenoh")]
pub(crate) fn append(path: &Path, text: &str) -> Result<(), FileError> {
    let append = || {
        let mut file = fs::OpenOptions::new()
            .append(true)
            .create(true)
            .open(path)?;
        io::Write::write_all(&mut file, text.as_bytes())?;
        file.sync_all()
    };
    append().map_err(FileError::at(path))
}
