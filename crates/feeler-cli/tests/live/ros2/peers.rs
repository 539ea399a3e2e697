//! Programs in Python, and programs that end with the test.

use crate::skip;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

/// A program that ends with the test, however that ends.
pub struct Running(pub Child);

impl Drop for Running {
    fn drop(&mut self) {
        // One that has ended needs no end.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The Python of `variable`, if it can `import` so.
pub fn python(variable: &str, import: &str) -> Option<String> {
    let python = std::env::var(variable).unwrap_or_else(|_| "python3".into());
    let mut probe = Command::new(&python);
    probe
        .args(["-c", import])
        .current_dir(env!("CARGO_TARGET_TMPDIR"));
    let probe = probe.output();
    if probe.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    skip::skipped(&format!("{python} ({variable}) cannot {import}"));
    None
}

/// The Python that has pyzeros.
pub fn pyzeros() -> Option<String> {
    python("FEELER_PYTHON", "import pyzeros")
}

/// A script beside this file.
pub fn script(python: &str, name: &str, arguments: &[&str]) -> Command {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/live/ros2");
    let mut command = Command::new(python);
    command.arg(folder.join(name)).args(arguments);
    // pyzeros compiles what it needs, and keeps it where it runs.
    command.current_dir(env!("CARGO_TARGET_TMPDIR"));
    command.env("PYTHONDONTWRITEBYTECODE", "1");
    command.stdout(Stdio::piped());
    command
}

/// What a script says, line by line.
pub struct Words(BufReader<ChildStdout>);

impl Words {
    pub fn of(running: &mut Running) -> Self {
        let words = running.0.stdout.take().expect("its words");
        Self(BufReader::new(words))
    }

    /// The next line.
    pub fn next(&mut self) -> Value {
        let mut line = String::new();
        self.0.read_line(&mut line).expect("a line");
        serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line:?}"))
    }
}
