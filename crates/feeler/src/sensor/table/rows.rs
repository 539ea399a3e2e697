//! Reads the rows of a table.

use super::cells::{Cells, SEPARATORS, separator_name, separator_of};
use super::lines::{Line, Lines};
use super::number::{Decimals, NumberError};
use super::unit::{Quantity, are_units, is_no_unit, without_brackets};
use super::{Header, TableError};
use std::borrow::Cow;
use std::io::BufRead;

/// Handle of a numeric column ([`Table::number_column`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NumberColumn(usize);

/// Properties of a numeric column.
#[derive(Debug, Clone, Copy)]
struct Numbers {
    index: usize,
    quantity: Quantity,
    /// Factor that converts the column's unit to the unit of its quantity; `None` if the table states no unit.
    scale: Option<f64>,
}

/// Reads a table row by row. See [the module](super).
///
/// ```
/// use feeler::sensor::table::{Quantity, Table};
///
/// let text = "Picture;Fx [mN]\na.png;1500,5\n";
/// let mut table = Table::open(text.as_bytes())?;
/// let force = table.number_column("f_x", Quantity::Force)?.expect("a column");
/// assert!(table.advance()?);
/// assert_eq!((table.line(), table.number(force)), (2, Ok(1.5005)));
/// # Ok::<_, Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Table<R> {
    lines: Lines<R>,
    cells: Cells,
    header: Header,
    numbers: Vec<Numbers>,
    decimals: Decimals,
    /// `true` if the next row may contain units.
    is_first: bool,
}

impl<R: BufRead> Table<R> {
    /// Reads the header of `stream`.
    ///
    /// # Errors
    /// If there is no header, or if reading the stream fails.
    pub fn open(stream: R) -> Result<Self, TableError> {
        let mut lines = Lines::new(stream);
        let mut named = None;
        loop {
            next_line(&mut lines)?.ok_or(TableError::Empty)?;
            let text = lines.text();
            check_text(text)?;
            if let Some(separator) = named_separator(text) {
                named = Some(separator);
                continue;
            }
            let line = lines.number();
            let separator = named.or_else(|| separator_of(text));
            let separator = separator.ok_or(TableError::Separators { line })?;
            let mut cells = Cells::new(separator);
            cells.split(text);
            if !cells.is_whole() {
                return Err(TableError::Quote { line });
            }
            let names = cells
                .iter()
                .map(|cell| String::from_utf8_lossy(cell).into_owned());
            return Ok(Self {
                header: Header::new(names.collect()),
                numbers: Vec::new(),
                decimals: Decimals::new(separator),
                is_first: true,
                lines,
                cells,
            });
        }
    }

    /// Header with the names of the columns.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Name of the separator between cells, for messages.
    pub fn separator(&self) -> &'static str {
        separator_name(self.cells.separator())
    }

    /// Returns the index of the text column `name`, or `None` if there is no such column.
    ///
    /// # Errors
    /// Returns [`TableError::Several`] if several columns match.
    pub fn column(&self, name: &str) -> Result<Option<usize>, TableError> {
        self.header.find(name)
    }

    /// Returns the numeric column `name`, or `None` if there is no such column.
    ///
    /// # Errors
    /// If several columns match, or if the column's unit does not fit `quantity`.
    pub fn number_column(
        &mut self,
        name: &str,
        quantity: Quantity,
    ) -> Result<Option<NumberColumn>, TableError> {
        let Some(index) = self.header.find(name)? else {
            return Ok(None);
        };
        let unit = self.header.unit(index);
        let scale = unit
            .map(|unit| self.scale(index, quantity, unit))
            .transpose()?;
        self.numbers.push(Numbers {
            index,
            quantity,
            scale,
        });
        Ok(Some(NumberColumn(self.numbers.len() - 1)))
    }

    fn scale(&self, index: usize, quantity: Quantity, unit: &str) -> Result<f64, TableError> {
        quantity.scale(unit).ok_or_else(|| TableError::Unit {
            column: self.header.names()[index].clone(),
            unit: unit.to_owned(),
            expected: quantity.units(),
        })
    }

    /// Advances to the next row that is not blank. Returns `false` at the end. Call
    /// [`number_column`](Self::number_column) before the first row.
    ///
    /// # Errors
    /// If the row is invalid ([`TableError::affects_one_row`]) or reading the stream fails.
    pub fn advance(&mut self) -> Result<bool, TableError> {
        while next_line(&mut self.lines)?.is_some() {
            let line = self.lines.number();
            self.cells.split(self.lines.text());
            if !self.cells.is_whole() {
                return Err(TableError::Quote { line });
            }
            if self.cells.iter().all(<[u8]>::is_empty) {
                continue;
            }
            self.check_count(line)?;
            if std::mem::take(&mut self.is_first) && self.take_units(line)? {
                continue;
            }
            let numbers = self
                .numbers
                .iter()
                .map(|numbers| self.cells.get(numbers.index));
            self.decimals.look(line, numbers);
            return Ok(true);
        }
        Ok(false)
    }

    /// Rejects a row with more or fewer cells than the header, ignoring empty cells at its end.
    fn check_count(&self, line: u64) -> Result<(), TableError> {
        let (cells, expected) = (self.cells.count(), self.header.names().len());
        let is_empty = |cell: &[u8]| cell.is_empty();
        if cells == expected || cells > expected && self.cells.iter().skip(expected).all(is_empty) {
            return Ok(());
        }
        let separator = self.cells.separator();
        Err(TableError::CellCount {
            line,
            cells,
            expected,
            separator,
        })
    }

    /// If the current row contains units, stores them and returns `true`.
    fn take_units(&mut self, line: u64) -> Result<bool, TableError> {
        let named =
            |numbers: &Numbers| String::from_utf8_lossy(self.cells.get(numbers.index)).into_owned();
        let units: Vec<_> = self.numbers.iter().map(named).collect();
        if !are_units(units.iter().map(String::as_str)) {
            return Ok(false);
        }
        for (number, unit) in units.iter().enumerate() {
            let unit = without_brackets(unit);
            if is_no_unit(unit) {
                continue;
            }
            let Numbers {
                index,
                quantity,
                scale,
            } = self.numbers[number];
            let own = self.scale(index, quantity, unit)?;
            if scale.is_some_and(|scale| scale != own) {
                let column = self.header.names()[index].clone();
                let unit = unit.to_owned();
                return Err(TableError::OtherUnit { column, unit, line });
            }
            self.numbers[number].scale = Some(own);
        }
        Ok(true)
    }

    /// Line number of the current row, from 1.
    pub fn line(&self) -> u64 {
        self.lines.number()
    }

    /// Cell of the current row in the column with index `column`; empty if missing.
    pub fn text(&self, column: usize) -> Cow<'_, str> {
        String::from_utf8_lossy(self.cells.get(column))
    }

    /// Cell of the current row in a numeric column, as text.
    pub fn number_text(&self, column: NumberColumn) -> Cow<'_, str> {
        self.text(self.numbers[column.0].index)
    }

    /// Parses the number in a column of the current row, and converts it to the unit of its [`Quantity`].
    ///
    /// # Errors
    /// If the cell is not a number, or is ambiguous.
    pub fn number(&self, column: NumberColumn) -> Result<f64, NumberError> {
        let Numbers { index, scale, .. } = self.numbers[column.0];
        let number = self.decimals.parse(self.cells.get(index))?;
        Ok(scale.map_or(number, |scale| scale * number))
    }

    /// Integer in a column of the current row, written as `3` or `3.0`; `None` if the cell is not an integer.
    pub fn whole(&self, column: usize) -> Option<u64> {
        /// Number above which `f64` cannot represent every integer.
        const LARGEST: f64 = (1_u64 << f64::MANTISSA_DIGITS) as f64;
        let text = self.text(column);
        let written_as_float = || {
            let number = self.decimals.parse(text.as_bytes()).ok()?;
            let is_whole = (0.0..LARGEST).contains(&number) && number.fract() == 0.0;
            is_whole.then_some(number as u64)
        };
        text.parse().ok().or_else(written_as_float)
    }
}

/// Advances to the next line that is not a comment. Returns `None` at the end.
fn next_line<R: BufRead>(lines: &mut Lines<R>) -> Result<Option<()>, TableError> {
    while let Some(line) = lines.next()? {
        let text = lines.text().trim_ascii_start();
        if line == Line::TooLong {
            let line = lines.number();
            return Err(TableError::TooLong { line });
        }
        if !text.is_empty() && !text.starts_with(b"#") {
            return Ok(Some(()));
        }
    }
    Ok(None)
}

/// Rejects a file whose first line is not text.
fn check_text(line: &[u8]) -> Result<(), TableError> {
    let what = match line {
        [b'P', b'K', 3, 4, ..] => "a workbook or another compressed file",
        [0x1f, 0x8b, ..] => "compressed by gzip",
        line if line.contains(&0) => "binary",
        _ => return Ok(()),
    };
    Err(TableError::NotText { what })
}

/// Separator set by a line `sep=;`, which spreadsheets write before the header.
fn named_separator(line: &[u8]) -> Option<u8> {
    // Trim the start only: the separator may be a tab.
    let line = line.trim_ascii_start();
    let line = line.strip_prefix(b"\"").unwrap_or(line);
    let (name, separator) = line.split_at_checked(4)?;
    let separator = match separator {
        [separator, rest @ ..] if rest.iter().all(|&byte| b" \",;".contains(&byte)) => separator,
        _ => return None,
    };
    (name.eq_ignore_ascii_case(b"sep=") && SEPARATORS.contains(separator)).then_some(*separator)
}

#[cfg(test)]
mod tests;
