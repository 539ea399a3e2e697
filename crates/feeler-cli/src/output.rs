//! Standard output that tolerates a closed pipe.

use std::io::{self, ErrorKind, Write};

/// A writer that discards output once its reader is gone, as in `feeler run … | head -1`. The command still
/// completes, and the exit status reports the result.
pub struct Output<W: Write> {
    writer: W,
    closed: bool,
}

impl<W: Write> Output<W> {
    /// Writes to `writer` until its reader is gone.
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
