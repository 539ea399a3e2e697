//! Serial port on Linux.

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags};
use rustix::termios::{
    ControlModes, OptionalActions, QueueSelector, SpecialCodeIndex, tcflush, tcgetattr, tcsetattr,
};
use std::fs::File;
use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

/// Maximum time for the operating system to accept bytes; a slower port has failed.
const SEND_TIMEOUT: Duration = Duration::from_millis(20);

/// A serial port, locked for exclusive use.
#[derive(Debug)]
pub struct SerialPort {
    file: File,
}

impl SerialPort {
    /// Opens the port at `path` with `baud_rate`, 8 data bits, no parity, 1 stop bit.
    ///
    /// # Errors
    /// If the port cannot be opened or configured, or if another program uses it.
    pub fn open(path: &str, baud_rate: u32) -> io::Result<Self> {
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let file = File::from(rustix::fs::open(path, flags, Mode::empty())?);
        file.try_lock()?;
        let mut settings = tcgetattr(&file)?;
        settings.make_raw();
        settings.control_modes |= ControlModes::CLOCAL | ControlModes::CREAD;
        settings.control_modes -= ControlModes::CSTOPB | ControlModes::CRTSCTS;
        settings.special_codes[SpecialCodeIndex::VMIN] = 0;
        settings.special_codes[SpecialCodeIndex::VTIME] = 0;
        settings.set_speed(baud_rate)?;
        tcsetattr(&file, OptionalActions::Now, &settings)?;
        let set = tcgetattr(&file)?.output_speed();
        if set != baud_rate {
            let reason = format!("expected {baud_rate} Bd, but the port supports {set} Bd");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
        tcflush(&file, QueueSelector::IOFlush)?;
        Ok(Self { file })
    }

    /// Discards received bytes that were not read.
    ///
    /// # Errors
    /// If the port has failed.
    pub fn discard_input(&mut self) -> io::Result<()> {
        Ok(tcflush(&self.file, QueueSelector::IFlush)?)
    }

    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// If the port has failed or does not accept the bytes within 20 ms.
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let deadline = Instant::now() + SEND_TIMEOUT;
        let mut rest = bytes;
        while !rest.is_empty() {
            match self.file.write(rest) {
                Ok(count) => rest = &rest[count..],
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    if !self.wait(PollFlags::OUT, deadline)? {
                        let reason = "the port accepts no bytes";
                        return Err(io::Error::new(io::ErrorKind::TimedOut, reason));
                    }
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Reads available bytes into `bytes`; waits up to `timeout` for the first byte. Returns the number of bytes, 0 on
    /// timeout.
    ///
    /// # Errors
    /// If the port has failed.
    pub fn receive(&mut self, bytes: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let deadline = Instant::now() + timeout;
        loop {
            if !self.wait(PollFlags::IN, deadline)? {
                return Ok(0);
            }
            match self.file.read(bytes) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(count) => return Ok(count),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Waits until the port is ready for `what`. Returns `false` after the deadline.
    fn wait(&self, what: PollFlags, deadline: Instant) -> io::Result<bool> {
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let timeout = Timespec {
                tv_sec: left.as_secs() as i64,
                tv_nsec: left.subsec_nanos().into(),
            };
            let mut ports = [PollFd::new(&self.file, what)];
            match poll(&mut ports, Some(&timeout)) {
                Ok(0) => return Ok(false),
                Ok(_) if ports[0].revents().contains(what) => return Ok(true),
                // The port has failed: no more bytes will arrive.
                Ok(_) => return Err(io::ErrorKind::BrokenPipe.into()),
                Err(rustix::io::Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
    }
}

impl Drop for SerialPort {
    /// Unlocks the port explicitly. A child process that is being started shares the open file until it executes
    /// another program, and would keep the lock that long.
    fn drop(&mut self) {
        // If this fails, closing the file unlocks it.
        let _ = self.file.unlock();
    }
}
