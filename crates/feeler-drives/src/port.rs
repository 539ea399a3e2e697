//! What a bus is reached through.

use std::io;

/// Bytes out, bytes in, and never for longer than was said: a [`SerialPort`](crate::serial::SerialPort), or that of an emulated bus in
/// [`Lockstep`](crate::emulator::Lockstep).
pub trait Port: Send {
    /// Forgets what arrived and was not read.
    ///
    /// # Errors
    /// When the port is gone.
    fn discard_input(&mut self) -> io::Result<()>;

    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// When the port is gone, or takes no bytes.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Reads what has arrived into `bytes`; waits for the first of it until `deadline`, s of the rig's time. How many bytes that were.
    ///
    /// # Errors
    /// When the port is gone.
    fn receive(&mut self, bytes: &mut [u8], deadline: f64) -> io::Result<usize>;
}
