//! The rows of a taxel array's table, one after the other.

use super::columns::{Columns, Role};
use super::header::{find_header, is_comment};
use super::row::{Values, is_time};
use super::times::Times;
use super::{Place, TaxelError, TaxelLayout, Trouble, Troubles};
use crate::sensor::table::{Cells, Line, Lines, MAX_LINE, TableError};
use glam::DVec3;
use std::io::{self, BufRead};

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub struct TaxelRow {
    /// Number of the row, from 0.
    pub number: u64,
    /// Its time, s: by its column, or by the rate.
    pub stamp: f64,
    /// Whether a sequence begins with it, as the first row's does.
    pub starts_sequence: bool,
    /// What stands in the columns x, y and z of each taxel; not a number where one of the three is none.
    pub values: Vec<DVec3>,
}

impl TaxelRow {
    /// A row of `taxels` taxels, to be filled.
    pub fn new(taxels: usize) -> Self {
        Self {
            number: 0,
            stamp: 0.0,
            starts_sequence: false,
            values: vec![DVec3::NAN; taxels],
        }
    }
}

/// Where the times of rows are from.
#[derive(Debug, Clone, Copy)]
enum Clock {
    /// A number of rows per second.
    Rate(f64),
    /// A column, in units of so many seconds.
    Column(f64),
}

/// Reads the rows of a table. Once it is open, nothing is allocated.
#[derive(Debug)]
pub struct TaxelRows<R> {
    lines: Lines<R>,
    cells: Cells,
    columns: Columns,
    header: Vec<u8>,
    /// Whether units may follow.
    is_below_header: bool,
    /// Whether the newest line is a row that was found in looking for a header.
    is_waiting: bool,
    clock: Clock,
    times: Times,
    values: Values,
    /// The hash of the row before.
    before: Option<u64>,
    sequence: Vec<u8>,
    next: u64,
    troubles: Troubles,
}

impl<R: BufRead> TaxelRows<R> {
    /// Reads the header of `stream`, a table as `layout` has it. A `rate` (Hz) stands before a column of time.
    ///
    /// Empty lines and those that begin with `#` are comments.
    ///
    /// # Errors
    /// When there is no such header, no way to tell the time, or the stream cannot be read.
    pub fn open(stream: R, layout: &TaxelLayout, rate: Option<f64>) -> Result<Self, TaxelError> {
        let clock = clock(layout, rate)?;
        let timed = matches!(clock, Clock::Column(_));
        let mut troubles = Troubles::default();
        let mut lines = Lines::new(stream);
        let (columns, cells, is_waiting) = find_header(&mut lines, layout, timed, &mut troubles)?;
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
            troubles,
        })
    }

    /// Fills `row` with the next; whether there is one.
    ///
    /// # Errors
    /// When the stream cannot be read, or the row below the header has other units than the layout, or decimal commas between commas.
    pub fn next(&mut self, row: &mut TaxelRow) -> io::Result<bool> {
        while self.next_line()? {
            let text = self.lines.text();
            let line = self.lines.number();
            if is_comment(text) {
                continue;
            }
            if !self.header.is_empty() && text == self.header {
                let place = Place { line, column: None };
                self.troubles.count(Trouble::HeaderAgain, place);
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
            let cells = (line, &self.cells);
            if self.values.read(&self.columns, cells, &mut self.troubles) {
                self.take(line, row);
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Refuses a table with commas between cells whose first row has more than 1.5 times as many as the header: its numbers have decimal commas, and
    /// all other rows are alike.
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

    /// Goes to the next line that is not too long; whether there is one.
    fn next_line(&mut self) -> io::Result<bool> {
        if std::mem::take(&mut self.is_waiting) {
            return Ok(true);
        }
        while let Some(line) = self.lines.next()? {
            if line == Line::Text {
                return Ok(true);
            }
            let line = self.lines.number();
            self.count(Trouble::TooLong, line);
        }
        Ok(false)
    }

    /// Makes `row` of the cells that were read.
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
            self.count(Trouble::Repeated, line);
        }
        row.values.clear();
        row.values.extend_from_slice(&self.values.values);
        self.next += 1;
    }

    /// The time of the row in `line`, s.
    fn time(&mut self, line: u64, unit: f64) -> f64 {
        let time = self.values.time.map(|time| time * unit);
        let Some(time) = time.filter(|&time| is_time(time)) else {
            // Counted where the cell was read, but for one that is out of range in its unit.
            if time.is_some() {
                self.count(Trouble::TimeUnreadable, line);
            }
            return self.times.newest();
        };
        if let Some(trouble) = self.times.take(time) {
            self.count(trouble, line);
        }
        time
    }

    fn count(&mut self, trouble: Trouble, line: u64) {
        self.troubles.count(trouble, Place { line, column: None });
    }

    /// The newest row's sequence, as it is named in its column; empty without one.
    pub fn sequence(&self) -> &[u8] {
        &self.sequence
    }

    /// Line of the newest row, from 1.
    pub fn line(&self) -> u64 {
        self.lines.number()
    }

    /// Rows so far.
    pub fn count_rows(&self) -> u64 {
        self.next
    }

    /// What was not as it should be.
    pub fn troubles(&self) -> &Troubles {
        &self.troubles
    }

    /// The same, to be added to.
    pub(super) fn troubles_mut(&mut self) -> &mut Troubles {
        &mut self.troubles
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        self.columns.header.names()
    }

    /// The column x of a taxel, from 0.
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
