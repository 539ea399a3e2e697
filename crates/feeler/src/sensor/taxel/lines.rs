//! Lines of a stream, in memory that is there already.

use std::io::{self, BufRead, ErrorKind};

/// Longest line of a table, bytes: 512 taxels take about 30,000.
pub const MAX_LINE: usize = 1 << 16;

/// What stands in a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// What [`Lines::text`] says.
    Text,
    /// More than [`MAX_LINE`] bytes; it was passed over.
    TooLong,
}

/// Reads line by line. Nothing is allocated but at the beginning.
#[derive(Debug)]
pub struct Lines<R> {
    stream: R,
    text: Vec<u8>,
    number: u64,
}

impl<R: BufRead> Lines<R> {
    /// The lines of `stream`.
    pub fn new(stream: R) -> Self {
        Self {
            stream,
            text: Vec::with_capacity(MAX_LINE),
            number: 0,
        }
    }

    /// Number of the newest line, from 1.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The newest line without its end.
    pub fn text(&self) -> &[u8] {
        let text = self.text.strip_suffix(b"\n").unwrap_or(&self.text);
        let text = text.strip_suffix(b"\r").unwrap_or(text);
        let first = self.number == 1;
        let mark = text.strip_prefix(b"\xef\xbb\xbf").filter(|_| first);
        mark.unwrap_or(text)
    }

    /// The next line; none at the end of the stream. What stands behind the last line feed is a line, too.
    ///
    /// # Errors
    /// When the stream cannot be read.
    pub fn next(&mut self) -> io::Result<Option<Line>> {
        self.text.clear();
        let mut fits = true;
        loop {
            let chunk = match self.stream.fill_buf() {
                Ok(chunk) => chunk,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            let end = chunk.iter().position(|&byte| byte == b'\n');
            let taken = end.map_or(chunk.len(), |end| end + 1);
            if taken == 0 && self.text.is_empty() && fits {
                return Ok(None);
            }
            fits &= self.text.len() + taken <= MAX_LINE;
            if fits {
                self.text.extend_from_slice(&chunk[..taken]);
            }
            self.stream.consume(taken);
            if end.is_some() || taken == 0 {
                self.number += 1;
                return Ok(Some(if fits { Line::Text } else { Line::TooLong }));
            }
        }
    }
}
