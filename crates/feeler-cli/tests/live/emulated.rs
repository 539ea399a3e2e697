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

/// Runs `feeler drives identify-current` with these `arguments` in `folder`, and presses Enter once `apply` has applied each
/// load that it requests. Returns its output.
pub fn sweep(folder: &Path, arguments: &[&str], mut apply: impl FnMut(f64)) -> String {
    let mut command = feeler(folder, arguments);
    let command = command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().expect("the program");
    let mut enter = child.stdin.take().expect("its input");
    let mut said = String::new();
    for line in BufReader::new(child.stdout.take().expect("its output")).lines() {
        let line = line.expect("a line");
        if let Some(rest) = line.strip_prefix("apply a load of ") {
            let load = rest.split(' ').next().and_then(|load| load.parse().ok());
            apply(load.expect(rest));
            writeln!(enter).expect("Enter");
        }
        said.push_str(&line);
        said.push('\n');
    }
    assert!(child.wait().expect("its status").success(), "{said}");
    said
}
