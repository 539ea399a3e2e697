//! Where a table begins.

use super::columns::{Columns, cells, number, shortened};
use super::lines::{Line, Lines};
use super::{Place, TaxelError, TaxelLayout, Trouble, Troubles};
use std::io::BufRead;

/// Lines in which a header is looked for.
const HEADER_LINES: u64 = 100;

/// Whether a line is empty or a comment.
pub fn is_comment(text: &[u8]) -> bool {
    let text = text.trim_ascii_start();
    text.is_empty() || text.starts_with(b"#")
}

/// Finds the columns: in a header, or, where the newest line is a row already, in the layout.
pub fn find_header<R: BufRead>(
    lines: &mut Lines<R>,
    layout: &TaxelLayout,
    timed: bool,
    troubles: &mut Troubles,
) -> Result<(Columns, bool), TaxelError> {
    let mut first = None;
    let mut seen = 0;
    while seen < HEADER_LINES {
        let Some(line) = lines.next()? else { break };
        let number = lines.number();
        if line == Line::TooLong {
            return Err(TaxelError::TooLong { line: number });
        }
        let text = lines.text();
        if is_comment(text) {
            continue;
        }
        seen += 1;
        let lossy = String::from_utf8_lossy(text);
        first.get_or_insert_with(|| shortened(&lossy).into_owned());
        let names: Vec<_> = cells(lossy.as_bytes(), layout.columns.delimiter)
            .map(|cell| String::from_utf8_lossy(cell).into_owned())
            .collect();
        if Columns::is_header(layout, &names) {
            return Ok((Columns::find(layout, names, timed)?, false));
        }
        if is_numbers(&names) {
            let columns = without_header(layout, timed, (number, names.len()))?;
            return Ok((columns, true));
        }
        let place = Place {
            line: number,
            column: None,
        };
        troubles.count(Trouble::NotARow, place);
    }
    Err(TaxelError::HeaderNotFound {
        column: layout.first_column(),
        lines: seen,
        first: first.unwrap_or_default(),
    })
}

/// Whether these are the cells of a row of numbers, some of which may be missing.
fn is_numbers(cells: &[String]) -> bool {
    let is_number = |cell: &String| number(cell.as_bytes()).is_some();
    let numbers = cells.iter().filter(|cell| is_number(cell)).count();
    numbers > 0 && cells.iter().all(|cell| cell.is_empty() || is_number(cell))
}

fn without_header(
    layout: &TaxelLayout,
    timed: bool,
    (line, cells): (u64, usize),
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
    let names = layout.names_without_header();
    Columns::find(layout, names, timed)
}
