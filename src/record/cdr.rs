//! ROS 2's wire format: Common Data Representation, little endian, behind four bytes that say so.

use super::channels::Message;
use super::error::RecordError;
use byteorder::LittleEndian;

/// Plain CDR, little endian, no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Writes `message` behind what `buffer` holds.
///
/// # Errors
/// When a value has no form in CDR (no message of [`super::channels`] has such a value).
pub fn encode<M: Message>(message: &M, buffer: &mut Vec<u8>) -> Result<(), RecordError> {
    let start = buffer.len();
    buffer.extend_from_slice(&ENCAPSULATION);
    cdr_encoding::to_writer::<M, LittleEndian, _>(&mut *buffer, message).map_err(|e| {
        buffer.truncate(start);
        RecordError::Encode {
            schema: M::SCHEMA_NAME,
            reason: e.to_string(),
        }
    })
}

/// Reads one message.
///
/// # Errors
/// What is wrong with `bytes`, in words.
pub fn decode<M: Message>(bytes: &[u8]) -> Result<M, String> {
    let Some((head, body)) = bytes.split_first_chunk::<4>() else {
        return Err(format!(
            "4 bytes of encapsulation expected, {} found",
            bytes.len()
        ));
    };
    if *head != ENCAPSULATION {
        return Err(format!(
            "encapsulation {ENCAPSULATION:?} expected, {head:?} found"
        ));
    }
    cdr_encoding::from_bytes::<M, LittleEndian>(body)
        .map(|(message, _)| message)
        .map_err(|e| e.to_string())
}
