//! Reads lines of a stream into a reused buffer.

use super::encoding::Utf8Stream;
use std::io::{self, BufRead, ErrorKind};

/// Maximum length of a line, bytes. A row of 512 taxels has about 30,000.
pub const MAX_LINE: usize = 1 << 16;

/// Kind of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// A line available from [`Lines::text`].
    Text,
    /// A line of more than [`MAX_LINE`] bytes, which was skipped.
    TooLong,
}

/// Reads lines, which end with CR, LF or both. Allocates only during construction.
#[derive(Debug)]
pub struct Lines<R> {
    stream: Utf8Stream<R>,
    text: Vec<u8>,
    number: u64,
    /// `true` if the last line ended with CR, so that a following LF belongs to it.
    after_cr: bool,
}

impl<R: BufRead> Lines<R> {
    /// Reads lines from `stream`.
    pub fn new(stream: R) -> Self {
        Self {
            stream: Utf8Stream::new(stream),
            text: Vec::with_capacity(MAX_LINE),
            number: 0,
            after_cr: false,
        }
    }

    /// Number of the current line, from 1.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Current line, without terminator and byte order mark.
    pub fn text(&self) -> &[u8] {
        let first = self.number == 1;
        let mark = (self.text.strip_prefix(b"\xef\xbb\xbf")).filter(|_| first);
        mark.unwrap_or(&self.text)
    }

    /// Reads the next line. Returns `None` at the end of the stream. An unterminated last line counts as a line.
    ///
    /// # Errors
    /// If reading the stream fails.
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
