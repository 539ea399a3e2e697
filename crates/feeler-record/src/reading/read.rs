//! Reads recordings, complete or damaged.

use super::collector::Collector;
use super::container::LIBRARY;
use super::part::Part;
use super::recording::Recording;
use super::rewritten::{ReadSeek, read_rewritten};
use super::scan::{Found, scan};
use crate::error::RecordError;
use crate::writing::sink::FACTS;
use ::mcap::records::Record;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

impl Recording {
    /// Reads a recording. From a damaged file, the readable part is returned, with [`complete`](Self::complete) `false`
    /// and the reason in [`problem`](Self::problem).
    ///
    /// # Errors
    /// If the file cannot be read or does not even contain the run's facts.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, RecordError> {
        Self::read_in_parts(path, &mut |_, _| {})
    }

    /// Reads a recording of any length in parts. After every [`PART`](crate::PART) messages, `part` is called with the recording so
    /// far and the fraction of the file that was read, 0 to 1. It may copy the data that it needs and [discard the
    /// rest](Self::discard_until). The result contains everything that was not discarded; its digest, end, gaps and
    /// problem refer to the whole file.
    ///
    /// # Errors
    /// See [`read`](Self::read).
    pub fn read_in_parts(
        path: impl AsRef<Path>,
        part: &mut dyn FnMut(&mut Self, f64),
    ) -> Result<Self, RecordError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(RecordError::file(path))?;
        let metadata = file.metadata().map_err(RecordError::file(path))?;
        let length = metadata.len();
        Self::read_from(&mut BufReader::new(file), length, path, part)
    }

    /// Like [`read_in_parts`](Self::read_in_parts), from an open `file` of `length` bytes, which errors call `path`.
    ///
    /// # Errors
    /// If not even the run's facts are readable.
    pub fn read_from(
        file: &mut (impl Read + Seek),
        length: u64,
        path: &Path,
        part: &mut dyn FnMut(&mut Self, f64),
    ) -> Result<Self, RecordError> {
        let mut part = |recording: &mut Self, offset: u64| {
            part(recording, (offset as f64 / length.max(1) as f64).min(1.0));
        };
        Self::from_reader(file, &mut part).map_err(|reason| RecordError::NothingReadable {
            path: path.to_path_buf(),
            reason,
        })
    }

    /// Reads a recording from memory.
    ///
    /// # Errors
    /// If not even the run's facts are readable. Returns the reason.
    pub fn from_bytes(file: &[u8]) -> Result<Self, String> {
        Self::from_reader(&mut Cursor::new(file), &mut |_, _| {})
    }

    fn from_reader(file: &mut dyn ReadSeek, part: &mut Part<'_>) -> Result<Self, String> {
        let as_written = is_as_written(file);
        file.rewind().map_err(|e| e.to_string())?;
        if !as_written {
            return read_rewritten(file, part);
        }
        let mut collector = Collector::default();
        let scanned = scan(file, &mut |found| collector.find(found, part));
        collector.finish(scanned.err())
    }
}

/// Returns `true` if a file is as feeler wrote it, with the run's facts at its start.
fn is_as_written(file: &mut dyn Read) -> bool {
    let (mut is_ours, mut begins_with_facts) = (false, false);
    // The rest of the file, including damage, is irrelevant here.
    let _ = scan(file, &mut |found| {
        match found {
            Found::Record(Record::Header(header), _) => {
                is_ours = header.library.starts_with(LIBRARY);
                return Ok(());
            }
            Found::Record(Record::Metadata(m), _) => begins_with_facts = m.name == FACTS,
            _ => {}
        }
        Err(String::new())
    });
    is_ours && begins_with_facts
}
