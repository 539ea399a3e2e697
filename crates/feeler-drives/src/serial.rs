//! Serial ports whose deadlines are in the time of a rig.

use crate::clock::RigClock;
use crate::port::Port;
use std::io;

/// A serial port, opened for exclusive use.
#[derive(Debug)]
pub struct SerialPort {
    port: feeler_serial::SerialPort,
    clock: RigClock,
}

impl SerialPort {
    /// Opens the port at `path` with `baud_rate`. `clock` measures the time of deadlines.
    ///
    /// # Errors
    /// If the port cannot be opened or configured, or if another program uses it.
    pub fn open(path: &str, baud_rate: u32, clock: RigClock) -> io::Result<Self> {
        let port = feeler_serial::SerialPort::open(path, baud_rate)?;
        Ok(Self { port, clock })
    }
}

impl Port for SerialPort {
    fn discard_input(&mut self) -> io::Result<()> {
        self.port.discard_input()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.send(bytes)
    }

    fn receive(&mut self, bytes: &mut [u8], deadline: f64) -> io::Result<usize> {
        let left = self.clock.real_time(deadline - self.clock.now());
        self.port.receive(bytes, left)
    }
}
