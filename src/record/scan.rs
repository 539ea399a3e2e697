//! Walks the records of an MCAP file that may be cut short or damaged.
//!
//! The MCAP library's own readers stop at the first fault without saying what was good before it,
//! and take lengths in the file at their word. Here a chunk is used only when its checksum holds,
//! no length is believed beyond the bytes that are there, and what was read before a fault stays.

use ::mcap::records::Record;
use ::mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use ::mcap::{MAGIC, parse_record};

const CHUNK: u8 = 0x06;
const ATTACHMENT: u8 = 0x09;
const DATA_END: u8 = 0x0F;
/// Bytes of an attachment's checksum.
const CHECKSUM: usize = 4;
/// Opcode and length before every record's body.
const RECORD_HEAD: usize = 9;
/// Largest chunk that is unpacked, bytes. Ours are a quarter MiB.
const MAX_CHUNK: usize = 64 << 20;

/// Hands every record of `file` before the summary to `visit`, in order, chunks unpacked.
///
/// # Errors
/// Why it stopped before the end of the data, in words; all records before that were visited.
pub fn scan(
    file: &[u8],
    visit: &mut dyn FnMut(Record<'_>) -> Result<(), String>,
) -> Result<(), String> {
    let mut rest = file
        .strip_prefix(MAGIC)
        .ok_or("it does not start with the MCAP magic bytes")?;
    loop {
        let offset = file.len() - rest.len();
        let at = |reason: String| format!("at byte {offset} of {}: {reason}", file.len());
        let (opcode, record, body) = split_record(rest).map_err(at)?;
        match opcode {
            DATA_END => return Ok(()),
            CHUNK => scan_chunk(record, body, visit).map_err(at)?,
            _ => {
                let record = parse(opcode, body).map_err(at)?;
                visit(record).map_err(at)?;
            }
        }
        rest = &rest[record.len()..];
    }
}

/// Opcode, whole bytes and body of the first record.
fn split_record(bytes: &[u8]) -> Result<(u8, &[u8], &[u8]), String> {
    let cut = || "the file ends within a record".to_string();
    let (&opcode, rest) = bytes
        .split_first()
        .ok_or("the file ends without its end mark")?;
    let (length, rest) = rest.split_first_chunk::<8>().ok_or_else(cut)?;
    let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| cut())?;
    let body = rest.get(..length).ok_or_else(cut)?;
    let record = bytes.get(..RECORD_HEAD + length).ok_or_else(cut)?;
    Ok((opcode, record, body))
}

/// Parses a record whose body may be anything.
fn parse(opcode: u8, body: &[u8]) -> Result<Record<'static>, String> {
    // The library takes it for granted that an attachment's checksum follows its head.
    if opcode == ATTACHMENT && attachment_rest(body).is_none_or(|rest| rest.len() < CHECKSUM) {
        return Err("an attachment that is too short for its head and checksum".into());
    }
    parse_record(opcode, body)
        .map(Record::into_owned)
        .map_err(|e| e.to_string())
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

/// Checks and unpacks one chunk.
fn scan_chunk(
    record: &[u8],
    body: &[u8],
    visit: &mut dyn FnMut(Record<'_>) -> Result<(), String>,
) -> Result<(), String> {
    if let Record::Chunk { header, data } = parse(CHUNK, body)? {
        if !header.compression.is_empty() {
            let found = header.compression;
            return Err(format!(
                "an uncompressed chunk expected, one compressed by {found:?} found"
            ));
        }
        // The library takes it for granted that no record reaches beyond the chunk.
        let mut rest = &data[..];
        while !rest.is_empty() {
            let (_, record, _) = split_record(rest).map_err(|_| "a chunk ends within a record")?;
            rest = &rest[record.len()..];
        }
    }
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(MAX_CHUNK),
    );
    let mut rest = record;
    while let Some(event) = reader.next_event() {
        match event.map_err(|e| e.to_string())? {
            LinearReadEvent::ReadRequest(need) => {
                let length = need.min(rest.len());
                reader.insert(length).copy_from_slice(&rest[..length]);
                reader.notify_read(length);
                rest = &rest[length..];
            }
            LinearReadEvent::Record { opcode, data } => visit(parse(opcode, data)?)?,
        }
    }
    Ok(())
}
