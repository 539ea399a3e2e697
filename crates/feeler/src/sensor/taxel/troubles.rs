//! What was not as it should be in a table: counted, and where it was first.

use std::fmt;

/// A kind of trouble.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trouble {
    /// A line without any number is passed over.
    NotARow,
    /// A line is too long and passed over.
    TooLong,
    /// The header stands there again and is passed over.
    HeaderAgain,
    /// A row has more or fewer cells than the header.
    CellCount,
    /// A cell is empty.
    Empty,
    /// A cell is no number.
    NotANumber,
    /// A cell has another decimal mark than the cells before, or a comma that may divide thousands.
    DecimalMark,
    /// A cell is not finite, or larger than any sensor counts.
    NotFinite,
    /// The readings of a row are those of the one before it.
    Repeated,
    /// The time cannot be read.
    TimeUnreadable,
    /// The time is that of the row before it.
    TimeRepeated,
    /// The time is before that of the row before it.
    TimeBack,
    /// The time is much later than usual.
    TimeJump,
    /// A taxel has no valid value in the rows without load.
    NoZero,
}

impl Trouble {
    /// All kinds.
    pub const ALL: [Self; 14] = [
        Self::NotARow,
        Self::TooLong,
        Self::HeaderAgain,
        Self::CellCount,
        Self::Empty,
        Self::NotANumber,
        Self::DecimalMark,
        Self::NotFinite,
        Self::Repeated,
        Self::TimeUnreadable,
        Self::TimeRepeated,
        Self::TimeBack,
        Self::TimeJump,
        Self::NoZero,
    ];

    /// Whether the line is no frame.
    pub fn is_skipped(self) -> bool {
        matches!(self, Self::NotARow | Self::TooLong | Self::HeaderAgain)
    }

    /// What one is called, what more are called, and what comes of it.
    fn words(self) -> [&'static str; 3] {
        let no_force = "no force there";
        match self {
            Self::NotARow => ["line without a number", "lines without a number", "skipped"],
            Self::TooLong => [
                "line that is too long",
                "lines that are too long",
                "skipped",
            ],
            Self::HeaderAgain => [
                "line that repeats the header",
                "lines that repeat the header",
                "skipped",
            ],
            Self::CellCount => [
                "row with more or fewer cells than the header",
                "rows with more or fewer cells than the header",
                "no forces in such a frame",
            ],
            Self::Empty => ["empty cell", "empty cells", no_force],
            Self::NotANumber => [
                "cell that is no number",
                "cells that are no numbers",
                no_force,
            ],
            Self::DecimalMark => [
                "number whose decimal mark is not clear, or not that of the numbers before",
                "numbers whose decimal mark is not clear, or not that of the numbers before",
                no_force,
            ],
            Self::NotFinite => [
                "cell that is not finite",
                "cells that are not finite",
                no_force,
            ],
            Self::Repeated => [
                "row whose readings are those of the one before it",
                "rows whose readings are those of the one before",
                "kept",
            ],
            Self::TimeUnreadable => [
                "row whose time cannot be read",
                "rows whose time cannot be read",
                "taken at the time of the row before",
            ],
            Self::TimeRepeated => [
                "row at the time of the one before it",
                "rows at the time of the one before",
                "kept",
            ],
            Self::TimeBack => [
                "row whose time goes back",
                "rows whose time goes back",
                "kept",
            ],
            Self::TimeJump => [
                "row whose time jumps ahead",
                "rows whose time jumps ahead",
                "kept",
            ],
            Self::NoZero => [
                "taxel without a value in the rows without load",
                "taxels without a value in the rows without load",
                "no force there until the next sequence",
            ],
        }
    }
}

/// Where something stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// The line, from 1.
    pub line: u64,
    /// The column, from 0, where it is about one.
    pub column: Option<usize>,
}

/// How often there was trouble of a kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seen {
    /// The kind.
    pub trouble: Trouble,
    /// How often.
    pub count: u64,
    /// Where first.
    pub first: Place,
}

impl Seen {
    /// In words; `column` is the name of the column of [`first`](Self::first).
    pub fn in_words(&self, column: Option<&str>) -> String {
        let column = column.map_or(String::new(), |name| format!(", column {name:?}"));
        format!("{self}{column}")
    }
}

impl fmt::Display for Seen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [one, more, then] = self.trouble.words();
        let Self { count, first, .. } = self;
        let line = first.line;
        match count {
            1 => write!(f, "1 {one}: {then}; line {line}"),
            _ => write!(f, "{count} {more}: {then}; the first in line {line}"),
        }
    }
}

/// All troubles so far. Counting allocates nothing.
#[derive(Debug, Clone, Default)]
pub struct Troubles {
    seen: [Option<Seen>; Trouble::ALL.len()],
}

impl Troubles {
    /// Counts trouble at `first`.
    pub fn count(&mut self, trouble: Trouble, first: Place) {
        let seen = self.seen[trouble as usize].get_or_insert(Seen {
            trouble,
            count: 0,
            first,
        });
        seen.count += 1;
    }

    /// What there was, kind by kind.
    pub fn iter(&self) -> impl Iterator<Item = &Seen> {
        self.seen.iter().flatten()
    }

    /// Lines that were no frames.
    pub fn skipped(&self) -> u64 {
        let skipped = self.iter().filter(|seen| seen.trouble.is_skipped());
        skipped.map(|seen| seen.count).sum()
    }
}
