//! Splits and parses the records of an MCAP file.

use ::mcap::parse_record;
use ::mcap::records::{Record, op};

/// Size of an attachment's checksum in bytes.
const CHECKSUM: usize = 4;
/// Size of a record's opcode and length in bytes.
pub(crate) const RECORD_HEAD: usize = 9;

/// Splits off the first record: its opcode, its body, and its length including the header.
pub(crate) fn split_record(bytes: &[u8]) -> Option<(u8, &[u8], usize)> {
    let (&opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let body = rest.get(..length)?;
    Some((opcode, body, RECORD_HEAD + length))
}

/// Parses a record with an arbitrary body.
pub(crate) fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, String> {
    // The library assumes that an attachment's checksum follows its header.
    if opcode == op::ATTACHMENT && attachment_rest(body).is_none_or(|rest| rest.len() < CHECKSUM) {
        return Err("an attachment that is too short for its head and checksum".into());
    }
    parse_record(opcode, body).map_err(|e| e.to_string())
}

/// Rest of an attachment after its header (two times, two texts, data length), or `None` if the header is incomplete.
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
