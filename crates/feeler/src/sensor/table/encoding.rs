//! Decodes a stream in any Unicode encoding to UTF-8.

use std::io::{self, BufRead};

/// Maximum number of bytes of UTF-16 decoded at once.
const CHUNK: usize = 4096;

/// Text encoding of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    /// UTF-8, or another superset of ASCII.
    Utf8,
    /// UTF-16, little-endian.
    Utf16Le,
    /// UTF-16, big-endian.
    Utf16Be,
}

impl Encoding {
    /// Detects the encoding from the byte order mark, or else from the zero byte in the first character.
    fn of(start: &[u8]) -> Self {
        match *start {
            [0xff] | [0xff, 0xfe, ..] => Self::Utf16Le,
            [0xfe] | [0xfe, 0xff, ..] => Self::Utf16Be,
            [1..=0xff, 0, ..] => Self::Utf16Le,
            [0, 1..=0xff, ..] => Self::Utf16Be,
            _ => Self::Utf8,
        }
    }
}

/// Stream decoded to UTF-8. Allocates only during construction. UTF-8 is passed through unchanged.
#[derive(Debug)]
pub struct Utf8Stream<R> {
    stream: R,
    encoding: Option<Encoding>,
    /// Decoded text. Its first `taken` bytes have been consumed.
    text: Vec<u8>,
    taken: usize,
    /// First byte of an incomplete UTF-16 unit.
    half: Option<u8>,
    /// First unit of an incomplete surrogate pair.
    high: Option<u16>,
}

impl<R: BufRead> Utf8Stream<R> {
    /// Decodes `stream`.
    pub fn new(stream: R) -> Self {
        Self {
            stream,
            encoding: None,
            // A unit takes up to three bytes in UTF-8, plus two incomplete characters from earlier chunks.
            text: Vec::with_capacity(3 * CHUNK / 2 + 6),
            taken: 0,
            half: None,
            high: None,
        }
    }

    /// Returns the next decoded bytes; empty at the end.
    ///
    /// # Errors
    /// If reading the stream fails. If it was interrupted, the call should be repeated.
    pub fn fill(&mut self) -> io::Result<&[u8]> {
        let encoding = match self.encoding {
            Some(encoding) => encoding,
            None => *self.encoding.insert(Encoding::of(self.stream.fill_buf()?)),
        };
        if encoding == Encoding::Utf8 {
            return self.stream.fill_buf();
        }
        while self.taken == self.text.len() {
            self.text.clear();
            self.taken = 0;
            let chunk = self.stream.fill_buf()?;
            let count = chunk.len().min(CHUNK);
            if count == 0 {
                self.finish();
                break;
            }
            for &byte in &chunk[..count] {
                let Some(first) = self.half.take() else {
                    self.half = Some(byte);
                    continue;
                };
                let unit = match encoding {
                    Encoding::Utf16Be => u16::from_be_bytes([first, byte]),
                    _ => u16::from_le_bytes([first, byte]),
                };
                take_unit(&mut self.text, &mut self.high, unit);
            }
            self.stream.consume(count);
        }
        Ok(&self.text[self.taken..])
    }

    /// Consumes the first `count` bytes returned by [`fill`](Self::fill).
    pub fn consume(&mut self, count: usize) {
        match self.encoding {
            None | Some(Encoding::Utf8) => self.stream.consume(count),
            _ => self.taken = (self.taken + count).min(self.text.len()),
        }
    }

    /// Appends a replacement character if the stream ends with an incomplete character.
    fn finish(&mut self) {
        let is_torn = self.half.take().is_some() | self.high.take().is_some();
        if is_torn {
            push(&mut self.text, char::REPLACEMENT_CHARACTER);
        }
    }
}

/// Appends the characters completed by the UTF-16 unit `unit`. An unpaired surrogate is replaced.
fn take_unit(text: &mut Vec<u8>, high: &mut Option<u16>, unit: u16) {
    let first = high.take();
    if (0xd800..0xdc00).contains(&unit) {
        if first.is_some() {
            push(text, char::REPLACEMENT_CHARACTER);
        }
        *high = Some(unit);
        return;
    }
    for decoded in char::decode_utf16(first.into_iter().chain([unit])) {
        push(text, decoded.unwrap_or(char::REPLACEMENT_CHARACTER));
    }
}

fn push(text: &mut Vec<u8>, character: char) {
    text.extend_from_slice(character.encode_utf8(&mut [0; 4]).as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::io::BufReader;

    fn read(bytes: &[u8], at_once: usize) -> String {
        let mut stream = Utf8Stream::new(BufReader::with_capacity(at_once, bytes));
        let mut text = Vec::new();
        loop {
            let chunk = stream.fill().unwrap();
            if chunk.is_empty() {
                return String::from_utf8_lossy(&text).into_owned();
            }
            let count = chunk.len().div_ceil(2);
            text.extend_from_slice(&chunk[..count]);
            stream.consume(count);
        }
    }

    proptest! {
        /// Decoding gives the same text for each encoding and any chunk size.
        #[test]
        fn text_is_the_same_in_every_encoding(rest in "\\PC{0,40}", at_once in 2usize..9) {
            let text = format!("picture{rest}");
            let units: Vec<u16> = text.encode_utf16().collect();
            let marked = || std::iter::once(&0xfeff).chain(&units);
            let big: Vec<u8> = marked().flat_map(|unit| unit.to_be_bytes()).collect();
            let little: Vec<u8> = marked().flat_map(|unit| unit.to_le_bytes()).collect();
            let with_mark = format!("\u{feff}{text}");
            prop_assert_eq!(read(&big, at_once), &*with_mark);
            prop_assert_eq!(read(&little, at_once), &*with_mark);
            prop_assert_eq!(read(&little, 1), &*with_mark);
            prop_assert_eq!(read(&little[2..], at_once), &*text);
            prop_assert_eq!(read(&big[2..], at_once), &*text);
            prop_assert_eq!(read(text.as_bytes(), at_once), text);
        }

        #[test]
        fn any_bytes_are_decoded(bytes in proptest::collection::vec(any::<u8>(), 0..60), mark in 0usize..3) {
            let bytes = [[&[][..], &[0xff, 0xfe], &[0xfe, 0xff]][mark], &bytes].concat();
            let lossy = read(&bytes, 3);
            if mark == 2 {
                let units: Vec<u16> = bytes.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect();
                let text = String::from_utf16_lossy(&units);
                prop_assert!(lossy.starts_with(&text), "{lossy:?} {text:?}");
            }
        }
    }
}
