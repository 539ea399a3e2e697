//! Splits lines of a table into cells.

use super::lines::MAX_LINE;
use csv_core::ReaderBuilder;

/// Maximum number of cells per line; further cells are dropped.
const MAX_CELLS: usize = 1 << 14;

/// Splits a line into cells, in preallocated buffers.
#[derive(Debug)]
pub struct Cells {
    reader: csv_core::Reader,
    separator: u8,
    text: Vec<u8>,
    ends: Vec<usize>,
    count: usize,
    is_whole: bool,
}

impl Cells {
    /// Creates a splitter for one of [`SEPARATORS`], or for spaces, where consecutive ones count as one.
    pub fn new(separator: u8) -> Self {
        Self {
            reader: ReaderBuilder::new().delimiter(separator).build(),
            separator,
            text: vec![0; MAX_LINE + 1],
            ends: vec![0; MAX_CELLS],
            count: 0,
            is_whole: true,
        }
    }

    /// Splits a line of 1 to [`MAX_LINE`] bytes, without its terminator.
    pub fn split(&mut self, line: &[u8]) {
        self.reader.reset();
        let (_, _, written, count) = self
            .reader
            .read_record(line, &mut self.text, &mut self.ends);
        // The end of the line ends the last cell, unless the cell has an open quote.
        let (text, ends) = (&mut self.text[written..], &mut self.ends[count..]);
        let (ended, _, more, last) = self.reader.read_record(b"\n", text, ends);
        self.is_whole = ended == csv_core::ReadRecordResult::Record;
        self.count = count + last;
        if !self.is_whole
            && let Some(end) = self.ends.get_mut(self.count)
        {
            *end = written + more;
            self.count += 1;
        }
    }

    /// Returns `true` if all quotes of the line were closed and no cells were dropped.
    pub fn is_whole(&self) -> bool {
        self.is_whole
    }

    /// Separator between cells.
    pub fn separator(&self) -> u8 {
        self.separator
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.iter().count()
    }

    /// Returns the trimmed cell at `index`, or an empty one if missing. Not supported for cells separated by spaces.
    pub fn get(&self, index: usize) -> &[u8] {
        match index < self.count {
            true => self.cell(index),
            false => &[],
        }
    }

    /// All cells of the line, trimmed.
    pub fn iter(&self) -> impl Iterator<Item = &[u8]> {
        let cells = (0..self.count).map(|index| self.cell(index));
        cells.filter(|cell| self.separator != b' ' || !cell.is_empty())
    }

    fn cell(&self, index: usize) -> &[u8] {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        trimmed(&self.text[start..self.ends[index]])
    }
}

/// Non-ASCII spaces: no-break and narrow no-break.
const SPACES: [&[u8]; 2] = ["\u{a0}".as_bytes(), "\u{202f}".as_bytes()];

/// Removes spaces around a cell, and quotes after a space.
fn trimmed(cell: &[u8]) -> &[u8] {
    let mut cell = cell.trim_ascii();
    while let Some(less) = SPACES
        .iter()
        .find_map(|space| cell.strip_prefix(*space).or(cell.strip_suffix(*space)))
    {
        cell = less.trim_ascii();
    }
    let quoted = cell.strip_prefix(b"\"");
    quoted
        .and_then(|cell| cell.strip_suffix(b"\""))
        .unwrap_or(cell)
}

/// Possible separators.
pub const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

/// Detects the separator of a line: a semicolon or a tab if the line contains one outside quotes, else a comma. Returns
/// `None` if it contains both.
pub fn separator_of(line: &[u8]) -> Option<u8> {
    let mut is_quoted = false;
    let mut there = [false; 2];
    for &byte in line {
        match byte {
            b'"' => is_quoted = !is_quoted,
            b';' => there[0] |= !is_quoted,
            b'\t' => there[1] |= !is_quoted,
            _ => {}
        }
    }
    match there {
        [false, false] => Some(b','),
        [true, false] => Some(b';'),
        [false, true] => Some(b'\t'),
        [true, true] => None,
    }
}

/// Name of a separator, for messages.
pub fn separator_name(separator: u8) -> &'static str {
    match separator {
        b',' => "a comma",
        b';' => "a semicolon",
        b'\t' => "a tab",
        _ => "a space",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn split(separator: u8, line: &str) -> Vec<String> {
        let mut cells = Cells::new(separator);
        cells.split(line.as_bytes());
        cells
            .iter()
            .map(|c| String::from_utf8_lossy(c).into_owned())
            .collect()
    }

    #[test]
    fn cells_are_split_trimmed_and_unquoted() {
        assert_eq!(
            split(b',', "a, b ,\"c, \"\"d\"\"\", \"e\" ,"),
            ["a", "b", "c, \"d\"", "e", ""]
        );
        assert_eq!(split(b';', "0,5;1"), ["0,5", "1"]);
        assert_eq!(split(b';', "\u{a0}0,5 \u{202f};\u{a0}"), ["0,5", ""]);
        assert_eq!(split(b'\t', "a\t\tb"), ["a", "", "b"]);
        assert_eq!(split(b' ', "  1   2 3 "), ["1", "2", "3"]);
        let mut cells = Cells::new(b',');
        cells.split(b"1,\"2,3");
        assert!(!cells.is_whole() && cells.count() == 2);
        cells.split(b"1,2");
        assert!(cells.is_whole() && cells.count() == 2);
        cells.split(&[b','; MAX_LINE]);
        assert!(!cells.is_whole());
    }

    #[test]
    fn detects_the_separator_outside_quotes() {
        assert_eq!(separator_of(b"a,b"), Some(b','));
        assert_eq!(separator_of(b"f_x [N, raw];b"), Some(b';'));
        assert_eq!(separator_of(b"a\tb"), Some(b'\t'));
        assert_eq!(separator_of(b"\"a;b\",c"), Some(b','));
        assert_eq!(separator_of(b"a;b\tc"), None);
    }

    proptest! {
        /// Recovers the cells of independently quoted text.
        #[test]
        fn recovers_quoted_cells(cells in proptest::collection::vec("[a-z0-9,;\" ]{1,6}", 1..6)) {
            let quoted: Vec<_> = cells.iter().map(|cell| format!("\"{}\"", cell.replace('"', "\"\""))).collect();
            let trimmed: Vec<_> = cells.iter().map(|cell| {
                String::from_utf8_lossy(super::trimmed(cell.as_bytes())).into_owned()
            }).collect();
            prop_assert_eq!(split(b';', &quoted.join(";")), trimmed);
        }

        #[test]
        fn any_line_is_split(line in proptest::collection::vec(any::<u8>(), 0..80)) {
            for separator in SEPARATORS {
                let mut cells = Cells::new(separator);
                cells.split(&line);
                prop_assert!(cells.iter().all(|cell| cell.len() <= line.len()));
            }
        }
    }
}
