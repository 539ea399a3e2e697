//! Reads files of limited length.

use super::error::ConfigError;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Maximum size of an experiment or calibration file in bytes.
const MAX_TEXT: u64 = 16 << 20;

/// Reads a text file. Rejects files much longer than any valid one, such as devices and recordings.
pub(super) fn read(path: &Path, expected: &'static str) -> Result<String, ConfigError> {
    read_text(path).map_err(|source| ConfigError::Read {
        path: path.to_path_buf(),
        expected,
        source,
    })
}

/// Reads a text file in UTF-8 of at most 16 MiB.
pub(crate) fn read_text(path: &Path) -> io::Result<String> {
    let not_text = |_| io::Error::new(io::ErrorKind::InvalidData, "not text in UTF-8");
    String::from_utf8(read_at_most(path, MAX_TEXT)?).map_err(not_text)
}

/// Reads a file of at most `max` bytes.
pub(super) fn read_at_most(path: &Path, max: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(max + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max {
        let reason = format!("longer than {} MiB", max >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}
