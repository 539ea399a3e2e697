//! The `--json` option.

use serde::Serialize;
use std::io::{self, Write};

/// The `--json` option.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Json {
    /// Print one JSON object instead of text (see docs/json.md).
    #[arg(long)]
    pub json: bool,
}

/// Prints `object` as indented JSON.
pub fn print(object: &impl Serialize, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{}", serde_json::to_string_pretty(object)?)
}
