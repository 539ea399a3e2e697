//! Runs the `feeler` program in a separate folder for each test.

// Not every test binary uses all items.
#![allow(dead_code)]

use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Creates an empty folder for the test called `name`.
pub fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("program")
        .join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("the test's folder");
    path
}

/// Command that runs the program in `folder`.
pub fn feeler(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_feeler"));
    command
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null());
    command
}

/// An ended run of the program.
#[derive(Debug)]
pub struct Ended {
    pub status: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Ended {
    pub fn of(output: Output) -> Self {
        let ended = Self {
            status: output.status.code(),
            stdout: String::from_utf8(output.stdout).expect("text"),
            stderr: String::from_utf8(output.stderr).expect("text"),
        };
        assert!(!ended.stderr.contains("panicked"), "{ended:?}");
        ended
    }

    /// Asserts success without output on standard error, and returns standard output.
    pub fn done(self) -> String {
        assert_eq!(self.status, Some(0), "{self:?}");
        assert_eq!(self.stderr, "", "{self:?}");
        self.stdout
    }

    /// Asserts that the input was refused with a message that contains all of `words`, and returns standard error.
    pub fn refused(self, words: &[&str]) -> String {
        assert_eq!(self.status, Some(2), "{self:?}");
        for word in words {
            assert!(self.stderr.contains(word), "no {word:?} in {self:?}");
        }
        self.stderr
    }
}

/// Runs the program in `folder` to its end.
pub fn run(folder: &Path, arguments: &[&str]) -> Ended {
    Ended::of(feeler(folder, arguments).output().expect("the program"))
}

/// Makes a complete run called `run` in `folder`, and returns its folder.
pub fn whole_run(folder: &Path) -> PathBuf {
    let arguments = ["run", "cap-closing", "--sensing", "direct", "--out", "run"];
    run(folder, &arguments).done();
    folder.join("run")
}

/// `summary.json` of the run in `run_folder`.
pub fn summary(run_folder: &Path) -> Value {
    let text = fs::read_to_string(run_folder.join("summary.json")).expect("a summary");
    serde_json::from_str(&text).expect("JSON")
}

/// Value of the part called `name` of the claims in a summary.
pub fn part(summary: &Value, name: &str) -> f64 {
    let claims = summary["claims"].as_array().expect("claims").iter();
    let mut parts = claims.flat_map(|claim| claim["parts"].as_array().expect("parts"));
    let part = parts.find(|part| part["name"] == name);
    part.and_then(|part| part["value"].as_f64())
        .unwrap_or_else(|| panic!("no {name:?} in {summary}"))
}

/// Rows of a table with a header, as maps from column names to cells.
pub fn rows(path: &Path) -> Vec<HashMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    let rows = reader.deserialize().map(|row| row.expect("a row"));
    rows.collect()
}

/// Writes an experiment to `folder`: the reference experiment with `from` replaced by `to`.
pub fn experiment(folder: &Path, from: &str, to: &str) {
    let text = include_str!("../../../feeler-lab/experiments/cap-closing.toml");
    assert!(text.contains(from), "{from:?} is not in the experiment");
    fs::write(folder.join("my.toml"), text.replacen(from, to, 1)).expect("an experiment");
    let calibration = include_str!(
        "../../../feeler-lab/experiments/reference-fingertip.coupled.calibration.toml"
    );
    let name = "reference-fingertip.coupled.calibration.toml";
    fs::write(folder.join(name), calibration).expect("a calibration");
}

/// The part of a page that is shown without scripts. The compressed data in the scripts may contain any word.
pub fn document(path: &Path) -> String {
    let page = fs::read_to_string(path).unwrap();
    let (document, _) = page.split_once("<script").expect("a program");
    document.to_string()
}
