//! Serial ports of Windows and macOS.

use crate::clock::RigClock;
use crate::port::Port;
use serialport::ClearBuffer;
use std::io;
use std::time::Duration;

/// Maximum time for the operating system to accept bytes; a slower port has failed.
const SEND_TIMEOUT: Duration = Duration::from_millis(20);
/// Minimum timeout: `serialport` truncates to whole milliseconds.
const SHORTEST: Duration = Duration::from_millis(1);

/// A serial port, opened for exclusive use.
#[derive(Debug)]
pub struct SerialPort {
    port: Box<dyn serialport::SerialPort>,
    clock: RigClock,
}

impl SerialPort {
    /// Opens the port `path`, such as `COM3`, with `baud_rate`, 8 data bits, no parity, 1 stop bit. `clock` is the time
    /// of deadlines.
    ///
    /// # Errors
    /// If the port cannot be opened or configured, or if another program uses it.
    pub fn open(path: &str, baud_rate: u32, clock: RigClock) -> io::Result<Self> {
        let port = serialport::new(path, baud_rate)
            .timeout(SEND_TIMEOUT)
            .open()?;
        let set = port.baud_rate()?;
        if set != baud_rate {
            let reason = format!("expected {baud_rate} Bd, but the port supports {set} Bd");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
        port.clear(ClearBuffer::All)?;
        Ok(Self { port, clock })
    }
}

impl Port for SerialPort {
    fn discard_input(&mut self) -> io::Result<()> {
        Ok(self.port.clear(ClearBuffer::Input)?)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.set_timeout(SEND_TIMEOUT)?;
        self.port.write_all(bytes)
    }

    fn receive(&mut self, bytes: &mut [u8], deadline: f64) -> io::Result<usize> {
        loop {
            let left = self.clock.real_time(deadline - self.clock.now());
            self.port.set_timeout(left.max(SHORTEST))?;
            match self.port.read(bytes) {
                Ok(count) => return Ok(count),
                Err(error) if error.kind() == io::ErrorKind::TimedOut => {
                    if self.clock.now() >= deadline {
                        return Ok(0);
                    }
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }
}
