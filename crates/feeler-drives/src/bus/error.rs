//! Why servos were not asked, or did not answer as they should.

use super::ALERT;
use crate::packet::{PacketError, TooLong};
use std::io;

/// Why servos were not asked, or did not answer as they should.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// The port cannot be opened.
    #[error("{path}: {source}; expected a serial port that no other program uses")]
    Open {
        /// The port.
        path: String,
        /// What the system said.
        source: io::Error,
    },
    /// The port fails: a cable was pulled, say.
    #[error("the serial port fails: {0}; is its cable plugged in?")]
    Port(#[from] io::Error),
    /// A packet cannot be made.
    #[error(transparent)]
    TooLong(#[from] TooLong),
    /// A servo says nothing.
    #[error("servo {id} did not answer within {waited:.4} s")]
    NoReply {
        /// The servo.
        id: u8,
        /// How long it had, s.
        waited: f64,
    },
    /// An answer ended early.
    #[error("the answer of servo {id} broke off after {received} bytes")]
    CutShort {
        /// The servo.
        id: u8,
        /// Bytes that arrived.
        received: usize,
    },
    /// What arrived is no packet.
    #[error("the answer of servo {id} arrived damaged: {source}")]
    Damaged {
        /// The servo whose answer was expected.
        id: u8,
        /// What is wrong with it.
        source: PacketError,
    },
    /// Another answer than was asked for.
    #[error(
        "servo {id} was to answer with {expected} bytes of data, and servo {actual_id} answered with {actual}"
    )]
    Unexpected {
        /// The servo.
        id: u8,
        /// Bytes of data.
        expected: usize,
        /// Who answered.
        actual_id: u8,
        /// Bytes of data that it answered with.
        actual: usize,
    },
    /// What was sent came back.
    #[error(
        "the adapter sends back what it is sent: expected one without echo (switch it off, or the jumper that does it)"
    )]
    Echo,
    /// A servo did not do what it was told.
    #[error("servo {id} refused {what}: error {error:#04x}{}", in_words(*.error))]
    Refused {
        /// The servo.
        id: u8,
        /// What it was told.
        what: &'static str,
        /// Its error byte.
        error: u8,
    },
}

impl BusError {
    /// The servo that it is laid to, if it is to one.
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

/// The error numbers of Dynamixel protocol 2.0.
fn in_words(error: u8) -> &'static str {
    match error & !ALERT {
        1 => " (it could not process the instruction)",
        2 => " (it does not know the instruction)",
        3 => " (the instruction reached it damaged)",
        4 => " (the value is out of its range)",
        5 => " (the value is too short)",
        6 => " (the value is beyond its limit)",
        7 => " (that cannot be read or written, or not while the torque is on)",
        _ => "",
    }
}
