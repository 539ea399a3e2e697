//! What a command prints with `--json`.

use serde::Serialize;
use std::io::{self, Write};

/// The option.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Json {
    /// Print one JSON object instead of text, for other programs (docs/json.md).
    #[arg(long)]
    pub json: bool,
}

/// Prints an object.
pub fn print(object: &impl Serialize, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{}", serde_json::to_string_pretty(object)?)
}
