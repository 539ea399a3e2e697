//! Walks the records of an MCAP file that may be cut short or damaged.
//!
//! The MCAP library's own readers stop at the first fault without saying what was good before it,
//! and take lengths in the file at their word. Here a chunk is used only when its checksum holds,
//! no length is believed beyond the bytes that are there, and what was read before a fault stays.
//! No more than one record of the file is in memory at a time: pictures make recordings large.

use ::mcap::records::Record;
use ::mcap::{MAGIC, parse_record};
use std::io::Read;

const CHUNK: u8 = 0x06;
const ATTACHMENT: u8 = 0x09;
const DATA_END: u8 = 0x0F;
/// Bytes of an attachment's checksum.
const CHECKSUM: usize = 4;
/// Opcode and length before every record's body.
const RECORD_HEAD: usize = 9;
/// What stands in a chunk before its records: two times, size, checksum, the length of no compression's
/// name, length.
const CHUNK_HEAD: usize = 8 + 8 + 8 + 4 + 4 + 8;
/// Longest record, bytes. Our chunks are of half a MiB and a picture.
const MAX_RECORD: u64 = 64 << 20;

/// What is found in a file.
pub enum Found<'a> {
    /// A record, and where its body begins in the file, bytes from the start.
    Record(Record<'a>, u64),
    /// A chunk that is of no use: why, in words. What follows it is found, too.
    Damage(String),
}

/// Takes what is found.
pub type Visit<'a> = dyn FnMut(Found<'_>) -> Result<(), String> + 'a;

/// Hands every record of `file` before the summary to `visit`, in order, chunks unpacked. Of a chunk that is damaged,
/// none of its records.
///
/// # Errors
/// Why it stopped before the end of the data, in words; all records before that were visited.
pub fn scan(file: &mut dyn Read, visit: &mut Visit<'_>) -> Result<(), String> {
    let mut body = Vec::new();
    read_up_to(file, MAGIC.len() as u64, &mut body)?;
    if body != MAGIC {
        return Err("it does not start with the MCAP magic bytes".into());
    }
    let mut offset = MAGIC.len() as u64;
    loop {
        let at = |reason: String| format!("at byte {offset}: {reason}");
        let opcode = read_record(file, &mut body).map_err(at)?;
        let start = offset + RECORD_HEAD as u64;
        match opcode {
            DATA_END => return Ok(()),
            CHUNK => match check_chunk(&body) {
                Ok(data) => visit_chunk(data, start, visit).map_err(at)?,
                Err(reason) => visit(Found::Damage(at(reason)))?,
            },
            _ => {
                let record = parse(opcode, &body).map_err(at)?;
                visit(Found::Record(record, start)).map_err(at)?;
            }
        }
        offset = start + body.len() as u64;
    }
}

/// Reads one record's body; its opcode.
fn read_record(file: &mut dyn Read, body: &mut Vec<u8>) -> Result<u8, String> {
    read_up_to(file, RECORD_HEAD as u64, body)?;
    let (&opcode, length) = body
        .split_first()
        .ok_or("the file ends without its end mark")?;
    let length = length.first_chunk::<8>().ok_or(CUT)?;
    let length = u64::from_le_bytes(*length);
    if length > MAX_RECORD {
        return Err(format!(
            "a record of at most {MAX_RECORD} bytes expected, one of {length} found"
        ));
    }
    read_up_to(file, length, body)?;
    if body.len() as u64 != length {
        return Err(CUT.into());
    }
    Ok(opcode)
}

const CUT: &str = "the file ends within a record";

/// Puts the next `length` bytes into `bytes`, or what there is. Makes room only for what comes.
fn read_up_to(file: &mut dyn Read, length: u64, bytes: &mut Vec<u8>) -> Result<(), String> {
    bytes.clear();
    let read = file.take(length).read_to_end(bytes);
    read.map(|_| ()).map_err(|e| e.to_string())
}

/// Opcode, body and length with head of the first record.
fn split_record(bytes: &[u8]) -> Option<(u8, &[u8], usize)> {
    let (&opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let body = rest.get(..length)?;
    Some((opcode, body, RECORD_HEAD + length))
}

/// Parses a record whose body may be anything.
fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, String> {
    // The library takes it for granted that an attachment's checksum follows its head.
    if opcode == ATTACHMENT && attachment_rest(body).is_none_or(|rest| rest.len() < CHECKSUM) {
        return Err("an attachment that is too short for its head and checksum".into());
    }
    parse_record(opcode, body).map_err(|e| e.to_string())
}

/// What follows an attachment's head (two times, two texts, the length of its data), if that is whole.
fn attachment_rest(body: &[u8]) -> Option<&[u8]> {
    let after_text = |bytes: &[u8]| {
        let length = u32::from_le_bytes(*bytes.first_chunk()?);
        usize::try_from(length).ok()?.checked_add(4)
    };
    let name = body.get(16..)?;
    let media_type = name.get(after_text(name)?..)?;
    let length = media_type.get(after_text(media_type)?..)?;
    length.get(8..)
}

/// The records of a chunk, if it is not damaged.
fn check_chunk(body: &[u8]) -> Result<&[u8], String> {
    let Record::Chunk { header, data } = parse(CHUNK, body)? else {
        return Err("a chunk expected".into());
    };
    if !header.compression.is_empty() {
        let found = header.compression;
        return Err(format!(
            "an uncompressed chunk expected, one compressed by {found:?} found"
        ));
    }
    let records = CHUNK_HEAD..CHUNK_HEAD + data.len();
    let data = body.get(records).ok_or("a chunk ends before its records")?;
    let (expected, actual) = (header.uncompressed_crc, crc32fast::hash(data));
    // No checksum is written as 0.
    if expected != 0 && expected != actual {
        return Err(format!(
            "a chunk with checksum {expected:08x} expected, {actual:08x} found"
        ));
    }
    let mut rest = data;
    while !rest.is_empty() {
        let (opcode, body, length) = split_record(rest).ok_or("a chunk ends within a record")?;
        parse(opcode, body)?;
        rest = &rest[length..];
    }
    Ok(data)
}

/// Visits the records of a chunk whose body begins at `start`.
fn visit_chunk(data: &[u8], start: u64, visit: &mut Visit<'_>) -> Result<(), String> {
    let mut rest = data;
    while let Some((opcode, body, length)) = split_record(rest) {
        let offset = data.len() - rest.len() + RECORD_HEAD + CHUNK_HEAD;
        visit(Found::Record(parse(opcode, body)?, start + offset as u64))?;
        rest = &rest[length..];
    }
    Ok(())
}
