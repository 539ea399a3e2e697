//! Incremental packet decoder.

use super::{BROADCAST, LONGEST, Protocol, check, instruction::STATUS};

/// Buffer size: twice the longest packet.
const CAPACITY: usize = 2 * (LONGEST + 7);

/// Sender of the packets to decode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sender {
    /// The computer, which sends instructions.
    Master,
    /// Servos, which send responses.
    Servo,
}

/// A valid packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Packet<'a> {
    /// Id of the addressed servo, or of the sender of a response.
    pub id: u8,
    /// Instruction; for a response of a Feetech servo, its status.
    pub code: u8,
    /// Parameters without byte stuffing. The first parameter of a Dynamixel servo's response is its error byte.
    pub parameters: &'a [u8],
}

/// Error of decoding a packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PacketError {
    /// Bytes outside of a packet.
    #[error("{count} bytes outside of a packet: expected a packet header")]
    Noise {
        /// Number of bytes.
        count: usize,
    },
    /// The length field is out of range.
    #[error("a packet with length {actual}: expected {least} to {most} bytes")]
    Length {
        /// Value of the length field.
        actual: usize,
        /// Minimum length.
        least: usize,
        /// Maximum length.
        most: usize,
    },
    /// The CRC or checksum is wrong because bytes were corrupted.
    #[error("a packet with checksum {actual:#06x}: expected {expected:#06x} for its content")]
    Check {
        /// Value computed from the content.
        expected: u16,
        /// Value received in the packet.
        actual: u16,
    },
}

/// Decodes packets from a stream of bytes. After an error, continues with the next header. Its buffer has a fixed size.
#[derive(Debug, Clone)]
pub struct Decoder {
    protocol: Protocol,
    sender: Sender,
    bytes: Vec<u8>,
    /// Number of processed bytes at the start of `bytes`.
    done: usize,
    /// Parameters of the latest packet without byte stuffing.
    parameters: Vec<u8>,
}

impl Decoder {
    /// Creates a decoder for packets from `sender`.
    pub fn new(protocol: Protocol, sender: Sender) -> Self {
        Self {
            protocol,
            sender,
            bytes: Vec::with_capacity(CAPACITY),
            done: 0,
            parameters: Vec::with_capacity(LONGEST),
        }
    }

    /// Discards all bytes.
    pub fn clear(&mut self) {
        self.bytes.clear();
        self.done = 0;
    }

    /// Received bytes that do not form a packet yet.
    pub fn pending(&self) -> &[u8] {
        &self.bytes[self.done..]
    }

    /// Parameters of the latest packet, see [`Packet::parameters`].
    pub fn parameters(&self) -> &[u8] {
        &self.parameters
    }

    /// Appends the beginning of `bytes` that fits into the buffer, and returns its length. After [`next`](Self::next)
    /// returned `None`, there is space for at least one packet.
    pub fn feed(&mut self, bytes: &[u8]) -> usize {
        self.bytes.drain(..self.done);
        self.done = 0;
        let taken = bytes.len().min(CAPACITY - self.bytes.len());
        self.bytes.extend_from_slice(&bytes[..taken]);
        taken
    }

    /// Returns the next packet or error, or `None` if more bytes are needed.
    #[allow(
        clippy::should_implement_trait,
        reason = "a packet borrows from the decoder"
    )]
    pub fn next(&mut self) -> Option<Result<Packet<'_>, PacketError>> {
        let found = self.find()?;
        Some(found.map(|(id, code)| Packet {
            id,
            code,
            parameters: &self.parameters,
        }))
    }

    /// Returns `true` if [`next`](Self::next) would return a packet or an error.
    pub fn has_packet(&self) -> bool {
        if self.noise() > 0 {
            return true;
        }
        let Some((_, begin, length)) = self.head() else {
            return false;
        };
        let (least, most) = self.lengths();
        !(least..=most).contains(&length) || self.pending().len() >= begin + length
    }

    /// Minimum and maximum value of the length field.
    fn lengths(&self) -> (usize, usize) {
        match self.protocol {
            Protocol::Dynamixel => (3, LONGEST),
            Protocol::Feetech | Protocol::FeetechScs => (2, u8::MAX.into()),
        }
    }

    /// Decodes the parameters of the next packet. Returns its id and code.
    fn find(&mut self) -> Option<Result<(u8, u8), PacketError>> {
        let noise = self.noise();
        if noise > 0 {
            self.done += noise;
            return Some(Err(PacketError::Noise { count: noise }));
        }
        let (id, begin, length) = self.head()?;
        let (least, most) = self.lengths();
        if !(least..=most).contains(&length) {
            // Skips only the first byte of the header, since the next packet may begin inside this one.
            self.done += 1;
            return Some(Err(PacketError::Length {
                actual: length,
                least,
                most,
            }));
        }
        let packet = self.pending().get(..begin + length)?;
        let (expected, actual) = check_bytes(self.protocol, packet);
        if expected != actual {
            self.done += 1;
            return Some(Err(PacketError::Check { expected, actual }));
        }
        let code = packet[begin];
        let end = packet.len() - self.protocol.check_length();
        let parameters = self.done + begin + 1..self.done + end;
        self.parameters.clear();
        if self.is_stuffed(id, code) {
            let from_code = &self.bytes[self.done + begin..parameters.end];
            unstuff(from_code, &mut self.parameters);
        } else {
            self.parameters.extend_from_slice(&self.bytes[parameters]);
        }
        self.done += begin + length;
        Some(Ok((id, code)))
    }

    /// Header of the pending packet: id, offset of the instruction or status, and length from there.
    fn head(&self) -> Option<(u8, usize, usize)> {
        match (self.protocol, self.pending()) {
            (Protocol::Dynamixel, [_, _, _, _, id, low, high, ..]) => {
                Some((*id, 7, u16::from_le_bytes([*low, *high]).into()))
            }
            (Protocol::Feetech | Protocol::FeetechScs, [_, _, id, length, ..]) => {
                Some((*id, 4, (*length).into()))
            }
            _ => None,
        }
    }

    /// Number of pending bytes before a complete or partial header.
    fn noise(&self) -> usize {
        let pending = self.pending();
        let begins = |at: &usize| {
            let rest = &pending[*at..];
            match self.protocol {
                Protocol::Dynamixel => {
                    let header = [0xFF, 0xFF, 0xFD, 0x00];
                    let known = rest.len().min(4);
                    rest[..known] == header[..known]
                }
                // An id is never 0xFF.
                Protocol::Feetech | Protocol::FeetechScs => match rest {
                    [0xFF] | [0xFF, 0xFF] => true,
                    [0xFF, 0xFF, id, ..] => *id != 0xFF,
                    _ => false,
                },
            }
        };
        let first = (0..pending.len()).find(begins);
        first.unwrap_or(pending.len())
    }

    /// Returns `true` if the packet has byte stuffing. The joint response to a fast sync read has none, because each
    /// servo knows only its part.
    fn is_stuffed(&self, id: u8, code: u8) -> bool {
        let together = self.sender == Sender::Servo && id == BROADCAST && code == STATUS;
        self.protocol == Protocol::Dynamixel && !together
    }
}

/// Expected and actual check bytes of a packet.
fn check_bytes(protocol: Protocol, packet: &[u8]) -> (u16, u16) {
    match (protocol, packet) {
        (Protocol::Dynamixel, [content @ .., low, high]) => {
            (check::crc(content), u16::from_le_bytes([*low, *high]))
        }
        (Protocol::Feetech | Protocol::FeetechScs, [_, _, content @ .., sum]) => {
            (check::sum(content).into(), (*sum).into())
        }
        // Unreachable: no packet is so short.
        _ => (0, 1),
    }
}

/// Appends the parameters in `bytes`, which begin with the instruction, to `parameters` without byte stuffing.
fn unstuff(bytes: &[u8], parameters: &mut Vec<u8>) {
    let mut index = 1;
    while index < bytes.len() {
        parameters.push(bytes[index]);
        let stuffed = index >= 2 && bytes[index - 2..=index] == [0xFF, 0xFF, 0xFD];
        index += if stuffed && bytes.get(index + 1) == Some(&0xFD) {
            2
        } else {
            1
        };
    }
}
