//! Standard output.

use serde::Serialize;
use std::io::{self, ErrorKind, Write};

/// Writer that ignores a closed pipe, such as that of `feeler run … | head -1`: the program completes its work, and the
/// exit status reports the result.
pub struct Output<W: Write> {
    writer: W,
    closed: bool,
}

impl<W: Write> Output<W> {
    /// Creates a writer to `writer`.
    pub fn new(writer: W) -> Self {
        Self {
            writer,
            closed: false,
        }
    }

    fn unless_closed<T>(&mut self, written: io::Result<T>, silent: T) -> io::Result<T> {
        match written {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.closed = true;
                Ok(silent)
            }
            other => other,
        }
    }
}

impl<W: Write> Write for Output<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.closed {
            return Ok(bytes.len());
        }
        let written = self.writer.write(bytes);
        self.unless_closed(written, bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.writer.flush();
        self.unless_closed(flushed, ())
    }
}

/// Prints `object` as indented JSON and a line feed.
///
/// # Errors
/// If it cannot be serialised or written.
pub fn print_json(object: &impl Serialize, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{}", serde_json::to_string_pretty(object)?)
}
