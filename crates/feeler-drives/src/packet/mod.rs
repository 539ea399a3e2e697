//! Packet codecs of all protocols, without I/O or clocks.
//!
//! Dynamixel protocol 2.0 (<https://emanual.robotis.com/docs/en/dxl/protocol2/>): `FF FF FD 00 | id | length, 2 bytes |
//! instruction | parameters | CRC-16, 2 bytes`. A servo's response has instruction 0x55 and an error byte before its
//! parameters; `FF FF FD` inside is stuffed with another `FD`.
//!
//! Feetech STS, SMS and SCS, which continue Dynamixel protocol 1.0: `FF FF | id | length | instruction (in a response:
//! status) | parameters | checksum`.

mod check;
mod decoder;
mod encode;
mod fast_sync;

pub use check::{crc, sum};
pub use decoder::{Decoder, Packet, PacketError, Sender};
pub use encode::{LONGEST, TooLong, encode};
pub use fast_sync::{FastBlock, complete_blocks, fast_blocks, fast_status, fast_status_length};

use serde::{Deserialize, Serialize};

/// Id that addresses all servos.
pub const BROADCAST: u8 = 0xFE;

/// Protocol of a bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Protocol {
    /// Dynamixel protocol 2.0: the X series and compatible servos.
    Dynamixel,
    /// Feetech STS and SMS series.
    Feetech,
    /// Feetech SCS series: the same packets, but big-endian values, another control table and no sync reads.
    FeetechScs,
}

impl Protocol {
    /// All protocols.
    pub const ALL: [Self; 3] = [Self::Dynamixel, Self::Feetech, Self::FeetechScs];

    /// Name as in an experiment file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dynamixel => "dynamixel",
            Self::Feetech => "feetech",
            Self::FeetechScs => "feetech-scs",
        }
    }

    /// Returns `true` if all servos can be asked at once.
    pub fn has_sync_read(self) -> bool {
        self != Self::FeetechScs
    }

    /// Maximum id of a servo.
    pub fn largest_id(self) -> u8 {
        match self {
            Self::Dynamixel => 252,
            Self::Feetech | Self::FeetechScs => 253,
        }
    }

    /// Number of bytes before the parameters: header, id, length, instruction.
    pub fn before_parameters(self) -> usize {
        match self {
            Self::Dynamixel => 8,
            Self::Feetech | Self::FeetechScs => 5,
        }
    }

    /// Number of bytes of the CRC or checksum.
    pub fn check_length(self) -> usize {
        match self {
            Self::Dynamixel => 2,
            Self::Feetech | Self::FeetechScs => 1,
        }
    }

    /// Length of a servo's response with `data` bytes of data, without byte stuffing.
    pub fn status_length(self, data: usize) -> usize {
        // Feetech's status replaces the instruction.
        let error = usize::from(self == Self::Dynamixel);
        self.before_parameters() + error + data + self.check_length()
    }
}

/// Instruction codes of all protocols.
pub mod instruction {
    /// Requests model number and firmware (Feetech: an empty response).
    pub const PING: u8 = 0x01;
    /// Reads a part of the control table.
    pub const READ: u8 = 0x02;
    /// Writes a part of the control table.
    pub const WRITE: u8 = 0x03;
    /// Restarts the servo.
    pub const REBOOT: u8 = 0x08;
    /// Marks a servo's response (Dynamixel).
    pub const STATUS: u8 = 0x55;
    /// Reads the same part of several servos' control tables; servos answer one after the other.
    pub const SYNC_READ: u8 = 0x82;
    /// Writes the same part of several servos' control tables; servos do not answer.
    pub const SYNC_WRITE: u8 = 0x83;
    /// Like a sync read, but all servos answer in a single packet (Dynamixel).
    pub const FAST_SYNC_READ: u8 = 0x8A;

    /// Name of an instruction, or `None` if unknown.
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
