//! From bytes, as they arrive, to packets.

use super::{BROADCAST, LONGEST, Protocol, check, instruction::STATUS};

/// Bytes that wait for the rest of their packet: the longest packet, and as many again.
const CAPACITY: usize = 2 * (LONGEST + 7);

/// Who sends what a decoder reads: the packets differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sender {
    /// The computer: instructions.
    Master,
    /// Servos: answers.
    Servo,
}

/// A packet that arrived whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Packet<'a> {
    /// Whom it is for, or who sent it.
    pub id: u8,
    /// The instruction; of a Feetech servo's answer, its status.
    pub code: u8,
    /// What follows, without stuffing. The first parameter of a Dynamixel servo's answer is its error byte.
    pub parameters: &'a [u8],
}

/// Why bytes are no packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PacketError {
    /// Bytes that belong to none.
    #[error("{count} bytes outside of a packet: expected the header of one")]
    Noise {
        /// How many.
        count: usize,
    },
    /// A length that no packet has.
    #[error("a packet with {actual} bytes after its length: expected {least} to {most}")]
    Length {
        /// What arrived.
        actual: usize,
        /// The least.
        least: usize,
        /// The most.
        most: usize,
    },
    /// CRC or checksum do not fit: bytes were changed on their way.
    #[error(
        "a packet whose check bytes are {actual:#06x}: expected {expected:#06x} by its content"
    )]
    Check {
        /// By the content.
        expected: u16,
        /// What arrived.
        actual: u16,
    },
}

/// Finds packets in a stream of bytes; after a fault it goes on with the next header. Its memory is fixed.
#[derive(Debug, Clone)]
pub struct Decoder {
    protocol: Protocol,
    sender: Sender,
    bytes: Vec<u8>,
    /// Bytes of `bytes` that are done with.
    done: usize,
    /// Parameters of the newest packet without stuffing.
    parameters: Vec<u8>,
}

impl Decoder {
    /// A decoder of what `sender` sends.
    pub fn new(protocol: Protocol, sender: Sender) -> Self {
        Self {
            protocol,
            sender,
            bytes: Vec::with_capacity(CAPACITY),
            done: 0,
            parameters: Vec::with_capacity(LONGEST),
        }
    }

    /// Forgets all bytes.
    pub fn clear(&mut self) {
        self.bytes.clear();
        self.done = 0;
    }

    /// Bytes that arrived and are no whole packet yet.
    pub fn pending(&self) -> &[u8] {
        &self.bytes[self.done..]
    }

    /// Parameters of the newest packet, as [`Packet::parameters`].
    pub fn parameters(&self) -> &[u8] {
        &self.parameters
    }

    /// Takes in as many of `bytes` as there is room for; how many that were. After [`next`](Self::next) found no further
    /// packet there is room for one.
    pub fn feed(&mut self, bytes: &[u8]) -> usize {
        self.bytes.drain(..self.done);
        self.done = 0;
        let taken = bytes.len().min(CAPACITY - self.bytes.len());
        self.bytes.extend_from_slice(&bytes[..taken]);
        taken
    }

    /// The next packet, or what is there in place of one; nothing where more bytes are needed.
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

    /// Whether [`next`](Self::next) has something to say already.
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

    /// Least and most bytes of a packet after its length.
    fn lengths(&self) -> (usize, usize) {
        match self.protocol {
            Protocol::Dynamixel => (3, LONGEST),
            Protocol::Feetech => (2, u8::MAX.into()),
        }
    }

    /// Puts the parameters of the next packet into place; its id and code.
    fn find(&mut self) -> Option<Result<(u8, u8), PacketError>> {
        let noise = self.noise();
        if noise > 0 {
            self.done += noise;
            return Some(Err(PacketError::Noise { count: noise }));
        }
        let (id, begin, length) = self.head()?;
        let (least, most) = self.lengths();
        if !(least..=most).contains(&length) {
            // Only the header's first byte is given up: the next packet may begin inside of this one.
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

    /// Id, where instruction or status stands, and length from there on, of the packet that begins with what is pending.
    fn head(&self) -> Option<(u8, usize, usize)> {
        match (self.protocol, self.pending()) {
            (Protocol::Dynamixel, [_, _, _, _, id, low, high, ..]) => {
                Some((*id, 7, u16::from_le_bytes([*low, *high]).into()))
            }
            (Protocol::Feetech, [_, _, id, length, ..]) => Some((*id, 4, (*length).into())),
            _ => None,
        }
    }

    /// Bytes before what is, or may become, a header.
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
                Protocol::Feetech => match rest {
                    [0xFF] | [0xFF, 0xFF] => true,
                    [0xFF, 0xFF, id, ..] => *id != 0xFF,
                    _ => false,
                },
            }
        };
        let first = (0..pending.len()).find(begins);
        first.unwrap_or(pending.len())
    }

    /// Servos do not stuff what they answer together: each knows only its own part of that packet.
    fn is_stuffed(&self, id: u8, code: u8) -> bool {
        let together = self.sender == Sender::Servo && id == BROADCAST && code == STATUS;
        self.protocol == Protocol::Dynamixel && !together
    }
}

/// The check bytes that a whole packet should have, and those that it has.
fn check_bytes(protocol: Protocol, packet: &[u8]) -> (u16, u16) {
    match (protocol, packet) {
        (Protocol::Dynamixel, [content @ .., low, high]) => {
            (check::crc(content), u16::from_le_bytes([*low, *high]))
        }
        (Protocol::Feetech, [_, _, content @ .., sum]) => {
            (check::sum(content).into(), (*sum).into())
        }
        // No packet is that short.
        _ => (0, 1),
    }
}

/// Appends `bytes`, the instruction first, to `parameters`, without the instruction and without stuffing.
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
