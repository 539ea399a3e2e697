//! What was said on an emulated bus, and when.

use crate::packet::{Packet, Sender};
use std::collections::VecDeque;

/// Most packets that are kept: the newest.
const KEPT: usize = 400_000;

/// A packet on the bus.
#[derive(Debug, Clone, PartialEq)]
pub struct LogEntry {
    /// When its last byte was on the wire, s.
    pub time: f64,
    /// Who sent it.
    pub sender: Sender,
    /// Its id.
    pub id: u8,
    /// Its instruction; of answers none.
    pub instruction: u8,
    /// Its parameters; of answers, their data.
    pub parameters: Vec<u8>,
}

/// The newest packets on a bus.
#[derive(Debug, Clone, Default)]
pub struct PacketLog {
    entries: VecDeque<LogEntry>,
}

impl PacketLog {
    /// What was said, oldest first.
    pub fn entries(&self) -> impl Iterator<Item = &LogEntry> {
        self.entries.iter()
    }

    /// Takes out what was said since it was last taken, oldest first.
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

    /// Adds the answer of servo `id`.
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
