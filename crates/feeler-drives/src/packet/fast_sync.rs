//! The packet in which several Dynamixel servos answer one fast sync read.
//!
//! After its instruction it has a block per servo: error, id, data, and the CRC of the packet up to there. The last of these is
//! the CRC of the whole packet.

use super::{BROADCAST, check, instruction::STATUS};

/// Bytes of a block beside its data: error, id, CRC.
const AROUND_DATA: usize = 4;
/// Bytes of the packet before its first block.
const BEFORE_BLOCKS: usize = 8;

/// What one servo answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FastBlock<'a> {
    /// Its error byte.
    pub error: u8,
    /// Its id.
    pub id: u8,
    /// What it has in the part of the table that was asked for.
    pub data: &'a [u8],
}

/// The blocks with `length` bytes of data each in the parameters of a packet that arrived whole.
pub fn fast_blocks(parameters: &[u8], length: usize) -> impl Iterator<Item = FastBlock<'_>> {
    // The decoder keeps the last block's CRC for itself.
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

/// How many servos' blocks, of `length` bytes of data each, have arrived of a packet that is not whole yet, all of whose
/// `bytes` so far are these: the next servo is the one that did not answer.
pub fn complete_blocks(bytes: &[u8], length: usize) -> usize {
    bytes.len().saturating_sub(BEFORE_BLOCKS) / (length + AROUND_DATA)
}

/// The packet in which servos answer, `bytes` in place of what is there: for whoever plays servos. Does not check that all
/// `blocks` have the same length, nor that the packet is not too long.
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
