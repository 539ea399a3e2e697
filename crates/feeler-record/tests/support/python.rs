//! Runs Python scripts that read recordings.

use crate::skip::skipped;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// JSON printed by `references/<script>` for the recording at `path`, or `None` if the Python named by `FEELER_PYTHON`
/// (default `python3`) lacks any of the `modules`.
pub fn read_by(script: &str, modules: &[&str], path: &Path) -> Option<Value> {
    run(script, modules, &[path])
}

/// Like [`read_by`], but with several paths.
pub fn run(script: &str, modules: &[&str], paths: &[&Path]) -> Option<Value> {
    let python = std::env::var("FEELER_PYTHON").unwrap_or_else(|_| "python3".into());
    let modules = modules.join(", ");
    let probe = Command::new(&python)
        .args(["-c", &format!("import {modules}")])
        .output();
    if !probe.is_ok_and(|output| output.status.success()) {
        skipped(&format!("{python} has not all of the modules {modules}"));
        return None;
    }
    let output = Command::new(&python)
        .arg(format!("references/{script}"))
        .args(paths)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    Some(serde_json::from_slice(&output.stdout).unwrap())
}
