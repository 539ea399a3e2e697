//! Serial port on Windows and macOS.

use serialport::ClearBuffer;
use std::io;
use std::time::{Duration, Instant};

/// Maximum time for the operating system to accept bytes; a slower port has failed.
const SEND_TIMEOUT: Duration = Duration::from_millis(20);
/// Minimum timeout: `serialport` truncates to whole milliseconds.
const SHORTEST: Duration = Duration::from_millis(1);

/// A serial port, opened for exclusive use.
#[derive(Debug)]
pub struct SerialPort {
    port: Box<dyn serialport::SerialPort>,
}

impl SerialPort {
    /// Opens the port `path`, such as `COM3`, with `baud_rate`, 8 data bits, no parity, 1 stop bit.
    ///
    /// # Errors
    /// If the port cannot be opened or configured, or if another program uses it.
    pub fn open(path: &str, baud_rate: u32) -> io::Result<Self> {
        let port = serialport::new(path, baud_rate)
            .timeout(SEND_TIMEOUT)
            // Boards with native USB send only while this line is set. Linux sets it when a port is opened.
            .dtr_on_open(true)
            .open()?;
        let set = port.baud_rate()?;
        if set != baud_rate {
            let reason = format!("expected {baud_rate} Bd, but the port supports {set} Bd");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
        port.clear(ClearBuffer::All)?;
        Ok(Self { port })
    }

    /// Discards received bytes that were not read.
    ///
    /// # Errors
    /// If the port has failed.
    pub fn discard_input(&mut self) -> io::Result<()> {
        Ok(self.port.clear(ClearBuffer::Input)?)
    }

    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// If the port has failed or does not accept the bytes within 20 ms.
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.set_timeout(SEND_TIMEOUT)?;
        self.port.write_all(bytes)
    }

    /// Reads available bytes into `bytes`; waits up to `timeout` for the first byte. Returns the number of bytes, 0 on
    /// timeout.
    ///
    /// # Errors
    /// If the port has failed.
    pub fn receive(&mut self, bytes: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let deadline = Instant::now() + timeout;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            self.port.set_timeout(left.max(SHORTEST))?;
            match self.port.read(bytes) {
                Ok(count) => return Ok(count),
                Err(error) if error.kind() == io::ErrorKind::TimedOut => {
                    if Instant::now() >= deadline {
                        return Ok(0);
                    }
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }
}
