//! Log of the packets on an emulated bus, as a table.

use crate::CommandError;
use feeler_console::PartFile;
use feeler_drives::emulator::LogEntry;
use feeler_drives::packet::{Sender, instruction};
use std::fs::File;

/// Table of a bus's packets, flushed at every write.
pub struct BusLog {
    rows: csv::Writer<File>,
    file: PartFile,
}

impl BusLog {
    /// Starts the table in `file`.
    pub fn new(file: PartFile) -> Result<Self, CommandError> {
        let mut rows = csv::Writer::from_writer(file.writer()?);
        rows.write_record(["time", "from", "id", "instruction", "bytes"])?;
        rows.flush()?;
        Ok(Self { rows, file })
    }

    /// Appends packets.
    pub fn write(&mut self, said: &[LogEntry]) -> Result<(), CommandError> {
        for packet in said {
            let (from, instruction) = match packet.sender {
                Sender::Master => ("master", named(packet.instruction)),
                Sender::Servo => ("servo", "status".into()),
            };
            let bytes = packet.parameters.iter().map(|byte| format!("{byte:02x}"));
            self.rows.write_record([
                format!("{:.6}", packet.time),
                from.into(),
                packet.id.to_string(),
                instruction,
                bytes.collect(),
            ])?;
        }
        Ok(self.rows.flush()?)
    }

    /// Moves the table to its final path.
    pub fn finish(self) -> Result<(), CommandError> {
        drop(self.rows);
        Ok(self.file.rename()?)
    }
}

fn named(code: u8) -> String {
    instruction::name(code).map_or_else(|| format!("{code:#04x}"), Into::into)
}
