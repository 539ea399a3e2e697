//! ROS 2's wire format: Common Data Representation, little endian, behind four bytes that say so.

use super::Message;
use byteorder::LittleEndian;

/// Why a message could not be put into its wire format or read from it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WireError {
    /// A value has no form in the wire format.
    #[error("{schema} cannot be encoded: {reason}")]
    Encode {
        /// Name of the message's schema.
        schema: &'static str,
        /// What was wrong.
        reason: String,
    },
    /// Bytes are not those of such a message.
    #[error("{schema}: {reason}")]
    Decode {
        /// Name of the message's schema.
        schema: &'static str,
        /// What was expected and what was found.
        reason: String,
    },
}

/// Plain CDR, little endian, no options: how every message begins.
pub const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Writes `message` behind what `buffer` holds.
///
/// # Errors
/// When a value has no form in CDR, in words; no message of ours has such a value.
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

/// Reads one message.
///
/// # Errors
/// What is wrong with `bytes`.
pub fn decode<M: Message>(bytes: &[u8]) -> Result<M, WireError> {
    let wrong = |reason| WireError::Decode {
        schema: M::SCHEMA_NAME,
        reason,
    };
    let Some((head, body)) = bytes.split_first_chunk::<4>() else {
        let length = bytes.len();
        return Err(wrong(format!(
            "4 bytes of encapsulation expected, {length} found"
        )));
    };
    // The two bytes behind it are options, which tell at most how many bytes of padding follow: whoever reads leaves them
    // (DDS-XTypes 1.3, 7.6.3.1.2).
    if head[..2] != ENCAPSULATION[..2] {
        let reason = format!("encapsulation {ENCAPSULATION:?} expected, {head:?} found");
        return Err(wrong(reason));
    }
    cdr_encoding::from_bytes::<M, LittleEndian>(body)
        .map(|(message, _)| message)
        .map_err(|e| wrong(e.to_string()))
}
