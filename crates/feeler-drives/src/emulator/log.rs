//! Log of the packets on an emulated bus.

use crate::packet::{Packet, Sender};
use std::collections::VecDeque;

/// Maximum number of packets kept; older ones are dropped.
const KEPT: usize = 400_000;

/// A packet on the bus.
#[derive(Debug, Clone, PartialEq)]
pub struct LogEntry {
    /// Time at which its last byte was on the wire, s.
    pub time: f64,
    /// Sender of the packet.
    pub sender: Sender,
    /// Id in the packet.
    pub id: u8,
    /// Instruction, or 0 for a response.
    pub instruction: u8,
    /// Parameters; for a response, its raw bytes.
    pub parameters: Vec<u8>,
}

/// The latest packets on a bus.
#[derive(Debug, Clone, Default)]
pub struct PacketLog {
    entries: VecDeque<LogEntry>,
}

impl PacketLog {
    /// All entries, oldest first.
    pub fn entries(&self) -> impl Iterator<Item = &LogEntry> {
        self.entries.iter()
    }

    /// Removes and returns all entries, oldest first.
    pub(super) fn take(&mut self) -> Vec<LogEntry> {
        self.entries.drain(..).collect()
    }

    /// Adds an instruction.
    pub(super) fn instruction(&mut self, time: f64, packet: Packet<'_>) {
        self.push(LogEntry {
            time,
            sender: Sender::Master,
            id: packet.id,
            instruction: packet.code,
            parameters: packet.parameters.to_vec(),
        });
    }

    /// Adds the response of servo `id`.
    pub(super) fn answer(&mut self, time: f64, id: u8, data: &[u8]) {
        self.push(LogEntry {
            time,
            sender: Sender::Servo,
            id,
            instruction: 0,
            parameters: data.to_vec(),
        });
    }

    fn push(&mut self, entry: LogEntry) {
        if self.entries.len() == KEPT {
            self.entries.pop_front();
        }
        self.entries.push_back(entry);
    }
}
