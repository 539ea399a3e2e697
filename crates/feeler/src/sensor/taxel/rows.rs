//! Reads the rows of a taxel array's table.

use super::columns::{Columns, Role};
use super::header::{find_header, is_comment};
use super::row::{Values, is_time};
use super::times::Times;
use super::{TablePosition, TableProblem, TableProblems, TaxelError, TaxelLayout};
use crate::sensor::table::{Cells, Line, Lines, MAX_LINE, TableError};
use glam::DVec3;
use std::io::{self, BufRead};

/// One row of a taxel array's table.
#[derive(Debug, Clone, PartialEq)]
pub struct TaxelRow {
    /// Index of the row, from 0.
    pub number: u64,
    /// Time of the row, s, from its column or from the rate.
    pub stamp: f64,
    /// `true` if the row starts a sequence, as the first row does.
    pub starts_sequence: bool,
    /// Values in the columns x, y and z of each taxel; NaN if one of the three is invalid.
    pub values: Vec<DVec3>,
}

impl TaxelRow {
    /// Creates a row for `taxels` taxels, without values.
    pub fn new(taxels: usize) -> Self {
        Self {
            number: 0,
            stamp: 0.0,
            starts_sequence: false,
            values: vec![DVec3::NAN; taxels],
        }
    }
}

/// Source of the times of the rows.
#[derive(Debug, Clone, Copy)]
enum Clock {
    /// Fixed rate, Hz.
    Rate(f64),
    /// Time column, with its unit in seconds.
    Column(f64),
}

/// Reads the rows of a taxel array's table. Allocates only when it is opened.
#[derive(Debug)]
pub struct TaxelRows<R> {
    lines: Lines<R>,
    cells: Cells,
    columns: Columns,
    header: Vec<u8>,
    /// `true` if the next row may contain units.
    is_below_header: bool,
    /// `true` if the current line is a row that was read during the search for a header and has not been returned yet.
    is_waiting: bool,
    clock: Clock,
    times: Times,
    values: Values,
    /// Hash of the previous row, to detect repetitions.
    before: Option<u64>,
    sequence: Vec<u8>,
    next: u64,
    problems: TableProblems,
}

impl<R: BufRead> TaxelRows<R> {
    /// Reads the header of `stream`, a table with the columns of `layout`. A `rate` (Hz) overrides a time column.
    ///
    /// Empty lines and lines that begin with `#` are comments.
    ///
    /// # Errors
    /// If the header does not match the layout, if there is neither a time column nor a rate, or if reading the stream
    /// fails.
    pub fn open(stream: R, layout: &TaxelLayout, rate: Option<f64>) -> Result<Self, TaxelError> {
        let clock = clock(layout, rate)?;
        let timed = matches!(clock, Clock::Column(_));
        let mut problems = TableProblems::default();
        let mut lines = Lines::new(stream);
        let (columns, cells, is_waiting) = find_header(&mut lines, layout, timed, &mut problems)?;
        let header = match is_waiting {
            true => Vec::new(),
            false => lines.text().to_vec(),
        };
        let taxels = layout.taxels.len();
        Ok(Self {
            values: Values::new(taxels, cells.separator(), MAX_LINE),
            lines,
            cells,
            columns,
            header,
            is_below_header: !is_waiting,
            is_waiting,
            clock,
            times: Times::default(),
            before: None,
            sequence: Vec::with_capacity(MAX_LINE),
            next: 0,
            problems,
        })
    }

    /// Reads the next row into `row`. Returns `false` at the end.
    ///
    /// # Errors
    /// If reading fails, if units differ from the layout, or if a comma-separated table has decimal commas.
    pub fn next(&mut self, row: &mut TaxelRow) -> io::Result<bool> {
        while self.next_line()? {
            let text = self.lines.text();
            let line = self.lines.number();
            if is_comment(text) {
                continue;
            }
            if !self.header.is_empty() && text == self.header {
                self.count(TableProblem::HeaderAgain, line);
                continue;
            }
            self.cells.split(text);
            if std::mem::take(&mut self.is_below_header) {
                let are_units = self.columns.are_units(&self.cells);
                if are_units.map_err(invalid)? {
                    continue;
                }
                self.refuse_decimal_commas(line).map_err(invalid)?;
            }
            let problems = &mut self.problems;
            if self.values.read(&self.columns, line, &self.cells, problems) {
                self.take(line, row);
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Rejects a comma-separated table whose first row has more than 1.5 times as many cells as the header: its numbers
    /// have decimal commas, and so do all other rows.
    fn refuse_decimal_commas(&self, line: u64) -> Result<(), TableError> {
        let (cells, expected) = (self.cells.count(), self.columns.roles.len());
        let separator = self.cells.separator();
        let filled = self.cells.iter().filter(|cell| !cell.is_empty()).count();
        match separator == b',' && 2 * filled > 3 * expected {
            true => Err(TableError::CellCount {
                line,
                cells,
                expected,
                separator,
            }),
            false => Ok(()),
        }
    }

    /// Advances to the next line of valid length. Returns `false` at the end.
    fn next_line(&mut self) -> io::Result<bool> {
        if std::mem::take(&mut self.is_waiting) {
            return Ok(true);
        }
        while let Some(line) = self.lines.next()? {
            if line == Line::Text {
                return Ok(true);
            }
            let line = self.lines.number();
            self.count(TableProblem::TooLong, line);
        }
        Ok(false)
    }

    /// Fills `row` with the values parsed from `line`.
    fn take(&mut self, line: u64, row: &mut TaxelRow) {
        let named = !self.values.sequence.is_empty();
        row.starts_sequence = self.next == 0 || named && self.values.sequence != self.sequence;
        if row.starts_sequence {
            self.times.restart();
        }
        if named {
            std::mem::swap(&mut self.sequence, &mut self.values.sequence);
        }
        row.number = self.next;
        row.stamp = match self.clock {
            Clock::Rate(rate) => self.next as f64 / rate,
            Clock::Column(unit) => self.time(line, unit),
        };
        let before = std::mem::replace(&mut self.before, self.values.hash);
        if !row.starts_sequence && before.is_some() && before == self.values.hash {
            self.count(TableProblem::Repeated, line);
        }
        row.values.clear();
        row.values.extend_from_slice(&self.values.values);
        self.next += 1;
    }

    /// Time of the current row, s.
    fn time(&mut self, line: u64, unit: f64) -> f64 {
        let time = self.values.time.map(|time| time * unit);
        let Some(time) = time.filter(|&time| is_time(time)) else {
            // Other errors were counted when the cell was read.
            if time.is_some() {
                self.count(TableProblem::TimeUnreadable, line);
            }
            return self.times.newest();
        };
        if let Some(problem) = self.times.take(time) {
            self.count(problem, line);
        }
        time
    }

    fn count(&mut self, problem: TableProblem, line: u64) {
        self.problems
            .count(problem, TablePosition { line, column: None });
    }

    /// Name of the current row's sequence; empty without a sequence column.
    pub fn sequence(&self) -> &[u8] {
        &self.sequence
    }

    /// Line number of the current row, from 1.
    pub fn line(&self) -> u64 {
        self.lines.number()
    }

    /// Number of rows read.
    pub fn count_rows(&self) -> u64 {
        self.next
    }

    /// Problems found in the table so far.
    pub fn problems(&self) -> &TableProblems {
        &self.problems
    }

    /// Mutable access to the problems, to add further ones.
    pub(super) fn problems_mut(&mut self) -> &mut TableProblems {
        &mut self.problems
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        self.columns.header.names()
    }

    /// Index of column x of a taxel.
    pub(super) fn column_of(&self, taxel: usize) -> Option<usize> {
        let is_first = |role: &Role| *role == Role::Value { taxel, axis: 0 };
        self.columns.roles.iter().position(is_first)
    }
}

fn invalid(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, error)
}

fn clock(layout: &TaxelLayout, rate: Option<f64>) -> Result<Clock, TaxelError> {
    let time = layout.columns.time.as_ref();
    match (rate, time, layout.rate) {
        (Some(rate), ..) if (1e-3..=1e5).contains(&rate) => Ok(Clock::Rate(rate)),
        (Some(actual), ..) => Err(TaxelError::Rate { actual }),
        (None, Some(time), _) => Ok(Clock::Column(time.unit.seconds())),
        (None, None, Some(rate)) => Ok(Clock::Rate(rate)),
        (None, None, None) => Err(TaxelError::NoTime),
    }
}
