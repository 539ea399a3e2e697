//! Lines of a stream, read into a reused buffer.

use super::encoding::Utf8Stream;
use std::io::{self, BufRead, ErrorKind};

/// Longest line of a table, bytes: 512 taxels take about 30,000.
pub const MAX_LINE: usize = 1 << 16;

/// What stands in a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// What [`Lines::text`] returns.
    Text,
    /// More than [`MAX_LINE`] bytes; it was passed over.
    TooLong,
}

/// Reads line by line. Lines end with CR, LF or both. Nothing is allocated but at the beginning.
#[derive(Debug)]
pub struct Lines<R> {
    stream: Utf8Stream<R>,
    text: Vec<u8>,
    number: u64,
    /// Whether the newest line ended with CR, to which an LF that follows belongs.
    after_cr: bool,
}

impl<R: BufRead> Lines<R> {
    /// The lines of `stream`.
    pub fn new(stream: R) -> Self {
        Self {
            stream: Utf8Stream::new(stream),
            text: Vec::with_capacity(MAX_LINE),
            number: 0,
            after_cr: false,
        }
    }

    /// Number of the newest line, from 1.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The newest line without its end, and without a byte order mark.
    pub fn text(&self) -> &[u8] {
        let first = self.number == 1;
        let mark = (self.text.strip_prefix(b"\xef\xbb\xbf")).filter(|_| first);
        mark.unwrap_or(&self.text)
    }

    /// Reads the next line; `None` at the end of the stream. What follows the last end of a line is a line, too.
    ///
    /// # Errors
    /// If the stream cannot be read.
    pub fn next(&mut self) -> io::Result<Option<Line>> {
        self.text.clear();
        let mut fits = true;
        let mut is_begun = false;
        loop {
            let chunk = match self.stream.fill() {
                Ok(chunk) => chunk,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            if chunk.is_empty() {
                self.number += u64::from(is_begun);
                return Ok(is_begun.then_some(if fits { Line::Text } else { Line::TooLong }));
            }
            if std::mem::take(&mut self.after_cr) && chunk[0] == b'\n' {
                self.stream.consume(1);
                continue;
            }
            is_begun = true;
            let end = chunk.iter().position(|&byte| matches!(byte, b'\n' | b'\r'));
            let length = end.unwrap_or(chunk.len());
            fits &= self.text.len() + length <= MAX_LINE;
            if fits {
                self.text.extend_from_slice(&chunk[..length]);
            }
            self.after_cr = end.is_some_and(|end| chunk[end] == b'\r');
            self.stream.consume(length + usize::from(end.is_some()));
            if end.is_some() {
                self.number += 1;
                return Ok(Some(if fits { Line::Text } else { Line::TooLong }));
            }
        }
    }
}
