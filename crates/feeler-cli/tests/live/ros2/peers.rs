//! Python peers, and processes that are killed on drop.

use crate::skip;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

/// A process that is killed on drop.
pub struct Running(pub Child);

impl Drop for Running {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The Python interpreter named by `variable`, or `None` if it cannot execute the statement `import`.
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

/// The Python interpreter, or `None` if it does not have pyzeros.
pub fn pyzeros() -> Option<String> {
    python("FEELER_PYTHON", "import pyzeros")
}

/// Command that runs a script of this folder.
pub fn script(python: &str, name: &str, arguments: &[&str]) -> Command {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/live/ros2");
    let mut command = Command::new(python);
    command.arg(folder.join(name)).args(arguments);
    // pyzeros compiles code on demand and caches it in the working directory.
    command.current_dir(env!("CARGO_TARGET_TMPDIR"));
    command.env("PYTHONDONTWRITEBYTECODE", "1");
    command.stdout(Stdio::piped());
    command
}

/// Output of a script, as lines of JSON.
pub struct Words(BufReader<ChildStdout>);

impl Words {
    pub fn of(running: &mut Running) -> Self {
        let words = running.0.stdout.take().expect("its output");
        Self(BufReader::new(words))
    }

    /// Reads the next line.
    pub fn next(&mut self) -> Value {
        let mut line = String::new();
        self.0.read_line(&mut line).expect("a line");
        serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line:?}"))
    }
}
