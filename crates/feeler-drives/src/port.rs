//! Ports to a bus.

use std::io;

/// Byte stream with timeouts: a `SerialPort`, or the port of an emulated bus in
/// [`Lockstep`](crate::emulator::Lockstep).
pub trait Port: Send {
    /// Discards received bytes that were not read.
    ///
    /// # Errors
    /// If the port has failed.
    fn discard_input(&mut self) -> io::Result<()>;

    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// If the port has failed or does not accept the bytes in time.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Reads available bytes into `bytes`; waits for the first byte until `deadline` (s of the rig's time). Returns the
    /// number of bytes, 0 on timeout.
    ///
    /// # Errors
    /// If the port has failed.
    fn receive(&mut self, bytes: &mut [u8], deadline: f64) -> io::Result<usize>;
}
