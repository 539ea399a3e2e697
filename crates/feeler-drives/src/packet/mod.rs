//! Packets of both protocols, as bytes and as what they say. Pure: nothing here reads, writes or waits.
//!
//! Dynamixel protocol 2.0 (<https://emanual.robotis.com/docs/en/dxl/protocol2/>):
//! `FF FF FD 00 | id | length, 2 bytes | instruction | parameters | CRC-16, 2 bytes`, where a servo's answer has the
//! instruction 0x55 and an error byte before its parameters, and `FF FF FD` inside is stuffed with another `FD`.
//! Feetech STS and SMS, which continue Dynamixel's protocol 1.0:
//! `FF FF | id | length | instruction or, of an answer, status | parameters | checksum`.

mod check;
mod decoder;
mod encode;
mod fast_sync;

pub use check::{crc, sum};
pub use decoder::{Decoder, Packet, PacketError, Sender};
pub use encode::{LONGEST, TooLong, encode};
pub use fast_sync::{FastBlock, complete_blocks, fast_blocks, fast_status};

use serde::{Deserialize, Serialize};

/// The id that all servos listen to.
pub const BROADCAST: u8 = 0xFE;

/// What the bytes on the bus mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Protocol {
    /// Dynamixel protocol 2.0: the X series and what is compatible with it.
    Dynamixel,
    /// Feetech STS and SMS series.
    Feetech,
}

impl Protocol {
    /// Largest id of a servo.
    pub fn largest_id(self) -> u8 {
        match self {
            Self::Dynamixel => 252,
            Self::Feetech => 253,
        }
    }

    /// Bytes of a packet before its parameters: header, id, length, instruction.
    pub fn before_parameters(self) -> usize {
        match self {
            Self::Dynamixel => 8,
            Self::Feetech => 5,
        }
    }

    /// Bytes of its CRC or checksum.
    pub fn check_length(self) -> usize {
        match self {
            Self::Dynamixel => 2,
            Self::Feetech => 1,
        }
    }

    /// Bytes of a servo's answer with so many bytes of data, unless they are stuffed.
    pub fn status_length(self, data: usize) -> usize {
        // The error byte of Feetech stands where an instruction does.
        let error = usize::from(self == Self::Dynamixel);
        self.before_parameters() + error + data + self.check_length()
    }
}

/// What a packet asks for.
pub mod instruction {
    /// Says model number and firmware (Feetech: nothing but that it is there).
    pub const PING: u8 = 0x01;
    /// Reads a part of the control table.
    pub const READ: u8 = 0x02;
    /// Writes a part of the control table.
    pub const WRITE: u8 = 0x03;
    /// Starts the servo afresh.
    pub const REBOOT: u8 = 0x08;
    /// A servo's answer (Dynamixel).
    pub const STATUS: u8 = 0x55;
    /// Reads the same part of several servos' tables, which answer one after the other.
    pub const SYNC_READ: u8 = 0x82;
    /// Writes the same part of several servos' tables; nobody answers.
    pub const SYNC_WRITE: u8 = 0x83;
    /// As a sync read, but all servos answer in one packet (Dynamixel).
    pub const FAST_SYNC_READ: u8 = 0x8A;

    /// The name of an instruction; none of one that is not known here.
    pub fn name(instruction: u8) -> Option<&'static str> {
        Some(match instruction {
            PING => "ping",
            READ => "read",
            WRITE => "write",
            REBOOT => "reboot",
            STATUS => "status",
            SYNC_READ => "sync_read",
            SYNC_WRITE => "sync_write",
            FAST_SYNC_READ => "fast_sync_read",
            _ => return None,
        })
    }
}
