//! ROS 2's wire format: little-endian Common Data Representation (CDR) after a header of four bytes.

use super::Message;
use byteorder::LittleEndian;

/// Errors returned when a message is encoded or decoded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WireError {
    /// A value cannot be represented in the wire format.
    #[error("{schema} cannot be encoded: {reason}")]
    Encode {
        /// Name of the message's schema.
        schema: &'static str,
        /// Description of the error.
        reason: String,
    },
    /// The bytes are not a valid message of this type.
    #[error("{schema}: {reason}")]
    Decode {
        /// Name of the message's schema.
        schema: &'static str,
        /// Expected and actual content.
        reason: String,
    },
}

/// Header of every message: plain CDR, little endian, no options.
pub const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Appends an encoded `message` to `buffer`.
///
/// # Errors
/// If a value cannot be represented in CDR. This does not occur for feeler's messages.
pub fn encode<M: Message>(message: &M, buffer: &mut Vec<u8>) -> Result<(), WireError> {
    let start = buffer.len();
    buffer.extend_from_slice(&ENCAPSULATION);
    cdr_encoding::to_writer::<M, LittleEndian, _>(&mut *buffer, message).map_err(|e| {
        buffer.truncate(start);
        WireError::Encode {
            schema: M::SCHEMA_NAME,
            reason: e.to_string(),
        }
    })
}

/// Decodes one message.
///
/// # Errors
/// If `bytes` is not a valid message.
pub fn decode<M: Message>(bytes: &[u8]) -> Result<M, WireError> {
    let wrong = |reason| WireError::Decode {
        schema: M::SCHEMA_NAME,
        reason,
    };
    let Some((head, body)) = bytes.split_first_chunk::<4>() else {
        let length = bytes.len();
        return Err(wrong(format!(
            "expected 4 bytes of encapsulation, got {length}"
        )));
    };
    // The other two bytes are options: at most the number of padding bytes at the end, which readers may ignore
    // (DDS-XTypes 1.3, 7.6.3.1.2).
    if head[..2] != ENCAPSULATION[..2] {
        let reason = format!("expected encapsulation {ENCAPSULATION:?}, got {head:?}");
        return Err(wrong(reason));
    }
    cdr_encoding::from_bytes::<M, LittleEndian>(body)
        .map(|(message, _)| message)
        .map_err(|e| wrong(e.to_string()))
}
