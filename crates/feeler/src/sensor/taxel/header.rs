//! Finds the header of a taxel array's table.

use super::columns::Columns;
use super::{TablePosition, TableProblem, TableProblems, TaxelError, TaxelLayout};
use crate::sensor::table::{Cells, Header, Line, Lines, is_number, separator_of, shortened};
use std::io::BufRead;

/// Maximum number of lines searched for a header.
const HEADER_LINES: u64 = 100;

/// Returns `true` if a line is empty or a comment.
pub fn is_comment(text: &[u8]) -> bool {
    let text = text.trim_ascii_start();
    text.is_empty() || text.starts_with(b"#")
}

/// Determines the columns from the header or, if a row of values comes first, from the layout. Returns the columns, the
/// cells of the current line, and `true` if that line is a row of values.
pub fn find_header<R: BufRead>(
    lines: &mut Lines<R>,
    layout: &TaxelLayout,
    timed: bool,
    problems: &mut TableProblems,
) -> Result<(Columns, Cells, bool), TaxelError> {
    let mut first = None;
    let mut line_count = 0;
    while line_count < HEADER_LINES {
        let Some(line) = lines.next()? else { break };
        let number = lines.number();
        if line == Line::TooLong {
            return Err(TaxelError::TooLong { line: number });
        }
        let text = lines.text();
        if is_comment(text) {
            continue;
        }
        line_count += 1;
        first.get_or_insert_with(|| shortened(&String::from_utf8_lossy(text)));
        // A layout's delimiter is one byte. A line with both semicolons and tabs is not a header.
        let separator = layout.columns.delimiter.map(|delimiter| delimiter as u8);
        let separator = separator.or_else(|| separator_of(text)).unwrap_or(b',');
        let mut cells = Cells::new(separator);
        cells.split(text);
        let names = cells
            .iter()
            .map(|cell| String::from_utf8_lossy(cell).into_owned());
        let header = Header::new(names.collect());
        if Columns::is_header(layout, &header) {
            return Ok((Columns::find(layout, header, timed)?, cells, false));
        }
        if is_numbers(&cells) {
            let columns = without_header(layout, timed, number, cells.count())?;
            return Ok((columns, cells, true));
        }
        let place = TablePosition {
            line: number,
            column: None,
        };
        problems.count(TableProblem::NotARow, place);
    }
    Err(TaxelError::HeaderNotFound {
        column: layout.first_column(),
        lines: line_count,
        first: first.unwrap_or_default(),
    })
}

/// Returns `true` if all non-empty cells are numbers and at least one is.
fn is_numbers(cells: &Cells) -> bool {
    let numbers = cells.iter().filter(|cell| is_number(cell)).count();
    numbers > 0 && cells.iter().all(|cell| cell.is_empty() || is_number(cell))
}

fn without_header(
    layout: &TaxelLayout,
    timed: bool,
    line: u64,
    cells: usize,
) -> Result<Columns, TaxelError> {
    let no_header = || TaxelError::NoHeader {
        line,
        cells,
        column: layout.first_column(),
    };
    let expected = layout.count_without_header().ok_or_else(no_header)?;
    if expected != cells {
        return Err(TaxelError::Unnamed {
            expected,
            actual: cells,
            line,
        });
    }
    let header = Header::new(layout.names_without_header());
    Columns::find(layout, header, timed)
}
