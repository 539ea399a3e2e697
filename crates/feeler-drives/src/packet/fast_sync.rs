//! Joint response of several Dynamixel servos to a fast sync read.
//!
//! After the instruction, the packet has one block per servo: error, id, data, and the CRC of the packet up to there.
//! The last CRC is the CRC of the whole packet.

use super::{BROADCAST, check, instruction::STATUS};

/// Number of bytes of a block in addition to its data: error, id, CRC.
const AROUND_DATA: usize = 4;
/// Number of bytes of the packet before its first block.
const BEFORE_BLOCKS: usize = 8;

/// Response of one servo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FastBlock<'a> {
    /// Error byte.
    pub error: u8,
    /// Id of the servo.
    pub id: u8,
    /// Requested part of its control table.
    pub data: &'a [u8],
}

/// Splits the `parameters` of a valid packet into blocks with `length` bytes of data each.
pub fn fast_blocks(parameters: &[u8], length: usize) -> impl Iterator<Item = FastBlock<'_>> {
    // The decoder removes the last block's CRC.
    let blocks = parameters.chunks(length + AROUND_DATA);
    blocks.filter_map(move |block| match block {
        [error, id, rest @ ..] if rest.len() >= length => Some(FastBlock {
            error: *error,
            id: *id,
            data: &rest[..length],
        }),
        _ => None,
    })
}

/// Number of complete blocks, with `length` bytes of data each, in the `bytes` of an incomplete packet. The next servo
/// is the one that did not answer.
pub fn complete_blocks(bytes: &[u8], length: usize) -> usize {
    bytes.len().saturating_sub(BEFORE_BLOCKS) / (length + AROUND_DATA)
}

/// Length (bytes) of the response to a fast sync read of `length` bytes from each of this number of `servos`. Excludes
/// byte stuffing.
pub fn fast_status_length(servos: usize, length: usize) -> usize {
    BEFORE_BLOCKS + servos * (length + AROUND_DATA)
}

/// Encodes the joint response of servos into `bytes`, replacing its content. Used by emulators. Does not check that all
/// `blocks` have the same length or that the packet is short enough.
pub fn fast_status<'a>(blocks: impl Iterator<Item = FastBlock<'a>> + Clone, bytes: &mut Vec<u8>) {
    let length: usize = blocks.clone().map(|b| b.data.len() + AROUND_DATA).sum();
    let [low, high] = (length as u16 + 1).to_le_bytes();
    bytes.clear();
    bytes.extend([0xFF, 0xFF, 0xFD, 0x00, BROADCAST, low, high, STATUS]);
    for block in blocks {
        bytes.extend([block.error, block.id]);
        bytes.extend(block.data);
        let crc = check::crc(bytes);
        bytes.extend(crc.to_le_bytes());
    }
}
