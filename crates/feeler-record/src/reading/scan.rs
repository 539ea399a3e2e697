//! Reads the records of an MCAP file that may be truncated or damaged.
//!
//! The MCAP library's readers stop at the first error without returning the valid records before it, and trust lengths
//! in the file. This reader uses a chunk only if its checksum matches, checks lengths against the available bytes, and
//! keeps everything read before an error. Only one record of the file is in memory at a time, because images make
//! recordings large.

use super::chunk::{MAX_CHUNK, Unpacked, unpack};
use super::record::{RECORD_HEAD, parse, split_record};
use ::mcap::MAGIC;
use ::mcap::records::{Record, op};
use std::io::{self, Read};

/// Maximum size of a record other than a chunk in bytes.
const MAX_RECORD: u64 = 64 << 20;

/// Content of a file.
pub enum Found<'a> {
    /// A record and the position of its body.
    Record(Record<'a>, Place),
    /// Description of a damaged chunk. The scan continues after it.
    Damage(String),
}

/// Position of a record's body.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Place {
    /// Offset in bytes: from the start of the file, or of the decompressed chunk.
    pub offset: u64,
    /// Offset of the compressed chunk's body from the start of the file in bytes, or `None` if the record is not
    /// compressed.
    pub chunk: Option<u64>,
}

impl Place {
    /// Approximate position in the file, in bytes from the start.
    pub fn in_file(self) -> u64 {
        self.chunk.unwrap_or(self.offset)
    }
}

/// Callback for the content of a file.
pub type Visit<'a> = dyn FnMut(Found<'_>) -> Result<(), String> + 'a;

/// Passes every record of `file` before the summary to `visit`, in order and with chunks unpacked. A damaged chunk is
/// passed as [`Found::Damage`].
///
/// # Errors
/// If reading stops before the end of the data. Returns a description. All records before it were visited.
pub fn scan(file: &mut dyn Read, visit: &mut Visit<'_>) -> Result<(), String> {
    let mut body = Vec::new();
    read_up_to(file, MAGIC.len() as u64, &mut body)?;
    if body != MAGIC {
        return Err("it does not start with the MCAP magic bytes".into());
    }
    let mut offset = MAGIC.len() as u64;
    loop {
        let at = |reason: String| format!("at byte {offset}: {reason}");
        let (opcode, length) = read_record(file, &mut body).map_err(at)?;
        let start = offset + RECORD_HEAD as u64;
        match opcode {
            op::DATA_END => return Ok(()),
            op::CHUNK => match unpack(&body) {
                Ok(chunk) => visit_chunk(&chunk, start, visit).map_err(at)?,
                Err(reason) => visit(Found::Damage(at(reason)))?,
            },
            // A foreign attachment that is too long for feeler was skipped.
            op::ATTACHMENT if length > MAX_RECORD => {}
            _ => {
                let record = parse(opcode, &body).map_err(at)?;
                let place = Place {
                    offset: start,
                    chunk: None,
                };
                visit(Found::Record(record, place)).map_err(at)?;
            }
        }
        offset = start + length;
    }
}

/// Reads one record into `body` and returns its opcode and length. An attachment above the size limit is skipped.
pub(crate) fn read_record(
    mut file: &mut dyn Read,
    body: &mut Vec<u8>,
) -> Result<(u8, u64), String> {
    read_up_to(file, RECORD_HEAD as u64, body)?;
    let (&opcode, length) = body
        .split_first()
        .ok_or("the file ends without its end mark")?;
    let length = length.first_chunk::<8>().ok_or(CUT)?;
    let length = u64::from_le_bytes(*length);
    let most = if opcode == op::CHUNK {
        MAX_CHUNK
    } else {
        MAX_RECORD
    };
    let read = match opcode {
        op::ATTACHMENT if length > most => {
            io::copy(&mut (&mut file).take(length), &mut io::sink()).map_err(|e| e.to_string())?
        }
        _ if length > most => {
            return Err(format!(
                "expected a record of at most {most} bytes, got one of {length}"
            ));
        }
        _ => {
            read_up_to(file, length, body)?;
            body.len() as u64
        }
    };
    match read == length {
        true => Ok((opcode, length)),
        false => Err(CUT.into()),
    }
}

const CUT: &str = "the file ends within a record";

/// Reads up to `length` bytes into `bytes`. Allocates only as much as is read.
fn read_up_to(file: &mut dyn Read, length: u64, bytes: &mut Vec<u8>) -> Result<(), String> {
    bytes.clear();
    let read = file.take(length).read_to_end(bytes);
    read.map(|_| ()).map_err(|e| e.to_string())
}

/// Visits the records of a chunk whose body begins at `start`.
fn visit_chunk(chunk: &Unpacked<'_>, start: u64, visit: &mut Visit<'_>) -> Result<(), String> {
    let records = &chunk.records;
    let mut rest = &records[..];
    while let Some((opcode, body, length)) = split_record(rest) {
        let inside = (records.len() - rest.len() + RECORD_HEAD) as u64;
        let place = match chunk.start {
            Some(before) => Place {
                offset: start + before as u64 + inside,
                chunk: None,
            },
            None => Place {
                offset: inside,
                chunk: Some(start),
            },
        };
        visit(Found::Record(parse(opcode, body)?, place))?;
        rest = &rest[length..];
    }
    Ok(())
}
