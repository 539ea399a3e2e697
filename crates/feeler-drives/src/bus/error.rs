//! Errors of communication with servos.

use super::ALERT;
use crate::packet::{PacketError, TooLong};
use std::io;

/// Error of communication with a servo.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// The port cannot be opened.
    #[error("{path}: {source}; expected a serial port that no other program uses")]
    Open {
        /// Path of the port.
        path: String,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The port failed, for example because its cable was unplugged.
    #[error("the serial port failed: {0}; check its cable")]
    Port(#[from] io::Error),
    /// The request does not fit into a packet.
    #[error(transparent)]
    TooLong(#[from] TooLong),
    /// A servo did not answer in time.
    #[error("servo {id} did not answer within {waited:.4} s")]
    NoReply {
        /// Id of the servo.
        id: u8,
        /// Timeout, s.
        waited: f64,
    },
    /// A response was incomplete.
    #[error("truncated response from servo {id} ({received} bytes)")]
    CutShort {
        /// Id of the servo.
        id: u8,
        /// Number of bytes received.
        received: usize,
    },
    /// A response was corrupted.
    #[error("corrupted response from servo {id}: {source}")]
    Damaged {
        /// Id of the servo expected to answer.
        id: u8,
        /// Error of the packet.
        source: PacketError,
    },
    /// The response does not match the request.
    #[error(
        "unexpected response: expected {expected} bytes from servo {id}, got {actual} from servo {actual_id}"
    )]
    Unexpected {
        /// Id of the servo expected to answer.
        id: u8,
        /// Expected number of bytes of data.
        expected: usize,
        /// Id in the response.
        actual_id: u8,
        /// Number of bytes of data in the response.
        actual: usize,
    },
    /// The adapter echoes sent bytes.
    #[error(
        "the adapter echoes sent bytes; expected an adapter without echo (check its settings and jumpers)"
    )]
    Echo,
    /// A servo rejected an instruction.
    #[error("servo {id} rejected {what}: error {error:#04x}{}", in_words(*.error))]
    Refused {
        /// Id of the servo.
        id: u8,
        /// The rejected instruction.
        what: &'static str,
        /// Error byte of the response.
        error: u8,
    },
}

impl BusError {
    /// Id of the servo that caused the error, or `None` if it is not due to a single servo.
    pub fn servo(&self) -> Option<u8> {
        match *self {
            Self::NoReply { id, .. }
            | Self::CutShort { id, .. }
            | Self::Damaged { id, .. }
            | Self::Unexpected { id, .. }
            | Self::Refused { id, .. } => Some(id),
            Self::Open { .. } | Self::Port(_) | Self::TooLong(_) | Self::Echo => None,
        }
    }
}

/// Describes an error number of Dynamixel protocol 2.0.
fn in_words(error: u8) -> &'static str {
    match error & !ALERT {
        1 => " (failed to process the instruction)",
        2 => " (unknown instruction)",
        3 => " (instruction corrupted in transit)",
        4 => " (value out of range)",
        5 => " (value too short)",
        6 => " (value beyond its limit)",
        7 => " (no access, or no access while torque is on)",
        _ => "",
    }
}
