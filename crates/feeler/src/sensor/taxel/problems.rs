//! Counts the problems in a table, and stores the first position of each kind.

use std::fmt;

/// Kind of problem in a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableProblem {
    /// A line without any number; skipped.
    NotARow,
    /// A line that is too long; skipped.
    TooLong,
    /// A line that repeats the header; skipped.
    HeaderAgain,
    /// The number of cells in a row differs from the header.
    CellCount,
    /// A cell is empty.
    Empty,
    /// A cell is not a number.
    NotANumber,
    /// A decimal mark differs from that of earlier cells, or a comma could be a thousands separator.
    DecimalMark,
    /// A number is infinite, NaN or implausibly large.
    NotFinite,
    /// The readings of a row equal those of the previous row.
    Repeated,
    /// The time of a row is invalid.
    TimeUnreadable,
    /// The time of a row equals that of the previous row.
    TimeRepeated,
    /// The time of a row is before that of the previous row.
    TimeBack,
    /// The time of a row is much later than expected.
    TimeJump,
    /// A taxel has no valid value in the unloaded rows.
    NoZero,
}

impl TableProblem {
    /// All kinds of problems.
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

    /// Returns `true` if the line with the problem is skipped.
    pub fn is_skipped(self) -> bool {
        matches!(self, Self::NotARow | Self::TooLong | Self::HeaderAgain)
    }

    /// Description for messages: singular, plural and consequence.
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
                "cell that is not a number",
                "cells that are not numbers",
                no_force,
            ],
            Self::DecimalMark => [
                "number whose decimal mark is ambiguous or differs from earlier numbers",
                "numbers whose decimal mark is ambiguous or differs from earlier numbers",
                no_force,
            ],
            Self::NotFinite => [
                "cell that is not finite",
                "cells that are not finite",
                no_force,
            ],
            Self::Repeated => [
                "row with the same readings as the one before",
                "rows with the same readings as the one before",
                "kept",
            ],
            Self::TimeUnreadable => [
                "row with an invalid time",
                "rows with an invalid time",
                "assigned the time of the row before",
            ],
            Self::TimeRepeated => [
                "row with the same time as the one before",
                "rows with the same time as the one before",
                "kept",
            ],
            Self::TimeBack => [
                "row whose time goes backward",
                "rows whose time goes backward",
                "kept",
            ],
            Self::TimeJump => [
                "row whose time jumps ahead",
                "rows whose time jumps ahead",
                "kept",
            ],
            Self::NoZero => [
                "taxel without a value in the unloaded rows",
                "taxels without a value in the unloaded rows",
                "no force there until the next sequence",
            ],
        }
    }
}

/// A position in a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TablePosition {
    /// Line number, from 1.
    pub line: u64,
    /// Column index, from 0, or `None` if the problem concerns the whole line.
    pub column: Option<usize>,
}

/// Number of problems of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProblemCount {
    /// Kind of problem.
    pub problem: TableProblem,
    /// Number of occurrences.
    pub count: u64,
    /// Position of the first occurrence.
    pub first: TablePosition,
}

impl ProblemCount {
    /// Formats the problem as text; `column` is the name of the column of [`first`](Self::first).
    pub fn in_words(&self, column: Option<&str>) -> String {
        let column = column.map_or(String::new(), |name| format!(", column {name:?}"));
        format!("{self}{column}")
    }
}

impl fmt::Display for ProblemCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [one, more, then] = self.problem.words();
        let Self { count, first, .. } = self;
        let line = first.line;
        match count {
            1 => write!(f, "1 {one}: {then}; line {line}"),
            _ => write!(f, "{count} {more}: {then}; the first in line {line}"),
        }
    }
}

/// All problems found so far. Counting does not allocate.
#[derive(Debug, Clone, Default)]
pub struct TableProblems {
    counts: [Option<ProblemCount>; TableProblem::ALL.len()],
}

impl TableProblems {
    /// Counts a problem, and stores its position `first` if it is the first of its kind.
    pub fn count(&mut self, problem: TableProblem, first: TablePosition) {
        let found = self.counts[problem as usize].get_or_insert(ProblemCount {
            problem,
            count: 0,
            first,
        });
        found.count += 1;
    }

    /// Problems found, by kind.
    pub fn iter(&self) -> impl Iterator<Item = &ProblemCount> {
        self.counts.iter().flatten()
    }

    /// Number of skipped lines.
    pub fn skipped(&self) -> u64 {
        let skipped = self.iter().filter(|found| found.problem.is_skipped());
        skipped.map(|found| found.count).sum()
    }
}
