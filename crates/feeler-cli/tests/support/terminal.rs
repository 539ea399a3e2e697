//! A pseudo-terminal, created by `script` of util-linux.

// Not every test binary uses all items.
#![allow(dead_code)]

use crate::skip::skipped;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A program in a terminal, and its output so far.
pub struct InTerminal {
    pub child: Child,
    drawn: String,
}

impl InTerminal {
    /// Starts `command` in `folder`, in a terminal of the usual 80 columns and 24 rows. Returns `None` if `script` is
    /// missing.
    pub fn start(folder: &Path, command: &str) -> Option<Self> {
        Self::start_in(folder, (80, 24), command)
    }

    /// Like [`Self::start`], but in a terminal of the given size.
    pub fn start_in(folder: &Path, (columns, rows): (u16, u16), command: &str) -> Option<Self> {
        let command = format!("stty rows {rows} cols {columns}; exec {command}");
        let child = Command::new("script")
            .args(["-qec", &command, "/dev/null"])
            .current_dir(folder)
            .env("TERM", "xterm-256color")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn();
        let Ok(child) = child else {
            skipped("the program `script` (util-linux), which creates a terminal, is missing");
            return None;
        };
        let drawn = String::new();
        Some(Self { child, drawn })
    }

    /// Reads until `word` is drawn.
    pub fn wait_for(&mut self, word: &str) {
        let from = self.drawn.len();
        while !self.drawn[from..].contains(word) {
            let mut bytes = [0; 1024];
            let output = self.child.stdout.as_mut().expect("output");
            let read = output.read(&mut bytes).expect("its output");
            assert!(
                read > 0,
                "the program ended without {word:?}: {:?}",
                self.drawn
            );
            let text = String::from_utf8_lossy(&bytes[..read]);
            self.drawn.push_str(&text);
        }
    }

    /// Presses a key.
    pub fn press(&mut self, key: &str) {
        let input = self.child.stdin.as_mut().expect("input");
        input.write_all(key.as_bytes()).expect("a key");
        input.flush().expect("a key");
    }

    /// Reads the remaining output. Returns all output and the exit status.
    pub fn end(mut self) -> (String, Option<i32>) {
        let output = self.child.stdout.as_mut().expect("output");
        let mut rest = Vec::new();
        // A terminal whose program has ended may return an error instead of the end of the file.
        let _ = output.read_to_end(&mut rest);
        self.drawn.push_str(&String::from_utf8_lossy(&rest));
        let status = self.child.wait().expect("its state");
        (self.drawn, status.code())
    }
}
