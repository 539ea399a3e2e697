//! Pseudo-terminals.

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, fcntl_setfl};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::OwnedFd;
use std::time::Duration;

/// A raw pseudo-terminal: other programs open its path like a serial port. Dropping it unplugs the port.
#[derive(Debug)]
pub struct PseudoTerminal {
    ours: File,
    /// The terminal's other end, kept open so that the port remains usable after a program closes it.
    _theirs: OwnedFd,
    path: String,
}

impl PseudoTerminal {
    /// Opens a pseudo-terminal.
    ///
    /// # Errors
    /// If the system has none left.
    pub fn open() -> io::Result<Self> {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let ours = openpt(flags)?;
        grantpt(&ours)?;
        unlockpt(&ours)?;
        let path = ptsname(&ours, Vec::new())?;
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let theirs = rustix::fs::open(path.as_c_str(), flags, Mode::empty())?;
        let mut settings = tcgetattr(&theirs)?;
        settings.make_raw();
        tcsetattr(&theirs, OptionalActions::Now, &settings)?;
        fcntl_setfl(&ours, OFlags::NONBLOCK)?;
        Ok(Self {
            ours: File::from(ours),
            _theirs: theirs,
            path: path.to_string_lossy().into_owned(),
        })
    }

    /// Path of the port for other programs.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Sends `bytes` without waiting. A program that does not read loses bytes, as on a real port.
    pub fn send(&mut self, bytes: &[u8]) {
        let _ = self.ours.write(bytes);
    }

    /// Waits at most `time` for bytes from the other program, reads them into `bytes` and returns their number.
    pub fn receive(&mut self, bytes: &mut [u8], time: Duration) -> usize {
        let timeout = Timespec {
            tv_sec: time.as_secs() as i64,
            tv_nsec: time.subsec_nanos().into(),
        };
        let mut ports = [PollFd::new(&self.ours, PollFlags::IN)];
        let ready = poll(&mut ports, Some(&timeout));
        if !ready.is_ok_and(|ready| ready > 0) {
            return 0;
        }
        self.ours.read(bytes).unwrap_or(0)
    }
}
