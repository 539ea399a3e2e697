//! Emulators that the program runs on a pseudo-terminal.

use crate::program::feeler;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Stdio};

/// An emulator whose process is killed on drop.
pub struct Emulated {
    child: Child,
    events: ChildStdin,
    /// Path of its pseudo-terminal.
    pub port: String,
}

impl Emulated {
    /// Starts the program in `folder` with `command` and `arguments`, and waits for its port.
    pub fn start(folder: &Path, command: &[&str], arguments: &[&str]) -> Self {
        let mut child = feeler(folder, command)
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program");
        let mut port = String::new();
        let stdout = child.stdout.take().expect("its output");
        BufReader::new(stdout).read_line(&mut port).expect("a path");
        let port = port.trim().to_string();
        // May be relative to the folder.
        assert!(!port.is_empty() && folder.join(&port).exists(), "{port:?}");
        Self {
            events: child.stdin.take().expect("its input"),
            child,
            port,
        }
    }

    /// Writes a line to its standard input.
    pub fn event(&mut self, event: &str) {
        writeln!(self.events, "{event}").expect("the emulator");
    }
}

impl Drop for Emulated {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
