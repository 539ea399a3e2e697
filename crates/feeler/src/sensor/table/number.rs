//! Numbers in cells, with a decimal point or a decimal comma.

/// Why a cell has no number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NumberError {
    /// It is not written as one.
    #[error("no number")]
    NotANumber,
    /// Its comma may be a decimal comma or divide thousands.
    #[error(
        "its comma may be a decimal comma or divide thousands; expected a decimal point, or another cell from which it is clear, as 0,5"
    )]
    Thousands,
    /// Other cells have the other decimal mark.
    #[error(
        "it has a decimal {own}, line {line} has a decimal {other}; expected one of the two in all lines"
    )]
    Mixed {
        /// The mark of this cell.
        own: Mark,
        /// The mark of the other cells.
        other: Mark,
        /// Line of the first of these, from 1.
        line: u64,
    },
}

/// What divides a number's fraction from the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// `.`
    Point,
    /// `,`
    Comma,
}

impl std::fmt::Display for Mark {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Point => "point",
            Self::Comma => "comma",
        })
    }
}

/// Longest number, bytes.
const LONGEST: usize = 64;

/// The decimal mark of a table: that of the first number from which it is clear. Allocates nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Decimals {
    mark: Option<(Mark, u64)>,
}

impl Decimals {
    /// Looks for the mark in the cells of `line` that may be numbers, unless it is known.
    pub fn look<'a>(&mut self, line: u64, mut cells: impl Iterator<Item = &'a [u8]>) {
        if self.mark.is_none() {
            self.mark = cells.find_map(mark).map(|mark| (mark, line));
        }
    }

    /// The number in a cell.
    ///
    /// # Errors
    /// If there is none, or it may be one of two.
    pub fn parse(&self, cell: &[u8]) -> Result<f64, NumberError> {
        let is_point = !cell.contains(&b',');
        let number = match is_point {
            true => plain_number(cell),
            false => with_comma(cell),
        };
        let number = number.ok_or(NumberError::NotANumber)?;
        let own = match (is_point, cell.contains(&b'.')) {
            (true, false) => return Ok(number),
            (true, true) => Mark::Point,
            (false, _) => Mark::Comma,
        };
        match self.mark {
            Some((other, line)) if other != own => Err(NumberError::Mixed { own, other, line }),
            None if may_be_thousands(cell) => Err(NumberError::Thousands),
            _ => Ok(number),
        }
    }
}

/// The mark that a cell shows, if it has a number.
fn mark(cell: &[u8]) -> Option<Mark> {
    if cell.contains(&b',') {
        return (with_comma(cell).is_some() && !may_be_thousands(cell)).then_some(Mark::Comma);
    }
    (cell.contains(&b'.') && plain_number(cell).is_some()).then_some(Mark::Point)
}

/// The number of a cell that is written as in Rust.
pub fn plain_number(cell: &[u8]) -> Option<f64> {
    str::from_utf8(cell).ok()?.parse().ok()
}

/// The number of a cell with one decimal comma.
fn with_comma(cell: &[u8]) -> Option<f64> {
    let mut text = [0; LONGEST];
    let text = text.get_mut(..cell.len())?;
    text.copy_from_slice(cell);
    let mut commas = text.iter_mut().filter(|byte| **byte == b',');
    *commas.next()? = b'.';
    // A second one, or a point beside it, is in no number.
    plain_number(text)
}

/// Whether a number's comma may divide thousands: one to three digits before it, not beginning with 0, and three behind it.
fn may_be_thousands(cell: &[u8]) -> bool {
    let digits = cell
        .strip_prefix(b"-")
        .or(cell.strip_prefix(b"+"))
        .unwrap_or(cell);
    let Some(comma) = digits.iter().position(|&byte| byte == b',') else {
        return false;
    };
    let (before, behind) = (&digits[..comma], &digits[comma + 1..]);
    (1..=3).contains(&before.len())
        && before[0] != b'0'
        && behind.len() == 3
        && behind.iter().all(u8::is_ascii_digit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(rows: &[&str]) -> Vec<Result<f64, NumberError>> {
        let mut decimals = Decimals::default();
        let mut line = 0;
        let read = rows.iter().flat_map(|row| {
            line += 1;
            let cells = || row.split(';').map(str::as_bytes);
            decimals.look(line, cells());
            cells().map(|cell| decimals.parse(cell)).collect::<Vec<_>>()
        });
        read.collect()
    }

    #[test]
    fn either_mark_is_read_and_both_are_refused() {
        assert_eq!(
            read(&["0.5;1e-3;7;-inf"]),
            [Ok(0.5), Ok(1e-3), Ok(7.0), Ok(f64::NEG_INFINITY)]
        );
        assert_eq!(read(&["0,5;1,5e-3;7"]), [Ok(0.5), Ok(1.5e-3), Ok(7.0)]);
        let mixed = |own, other| {
            Err(NumberError::Mixed {
                own,
                other,
                line: 1,
            })
        };
        assert_eq!(read(&["0,5", "1.5"])[1], mixed(Mark::Point, Mark::Comma));
        assert_eq!(read(&["0.5", "1,5"])[1], mixed(Mark::Comma, Mark::Point));
        for none in [
            "1,234.5",
            "1.234,5",
            "1,234,567",
            "",
            "N",
            "0,5 N",
            ",",
            "1 000",
        ] {
            assert_eq!(read(&[none]), [Err(NumberError::NotANumber)], "{none}");
        }
    }

    #[test]
    fn a_comma_that_may_divide_thousands_is_not_guessed() {
        assert_eq!(read(&["1,234"]), [Err(NumberError::Thousands)]);
        assert_eq!(read(&["-12,345"]), [Err(NumberError::Thousands)]);
        // Clear by another cell, of the same row or before.
        assert_eq!(read(&["1,234;0,5"]), [Ok(1.234), Ok(0.5)]);
        assert_eq!(read(&["1234,567", "1,234"]), [Ok(1234.567), Ok(1.234)]);
        assert_eq!(read(&["0,512"]), [Ok(0.512)]);
    }

    proptest! {
        /// A number with a comma is the number with a point, bit for bit.
        #[test]
        fn a_comma_changes_no_bit(number in -1e9..1e9) {
            let text = f64::to_string(&number).replace('.', ",");
            prop_assert_eq!(read(&["0,5", &text])[1], Ok(number));
        }

        #[test]
        fn any_cell_is_read_or_refused(cell in proptest::collection::vec(any::<u8>(), 0..80)) {
            let mut decimals = Decimals::default();
            decimals.look(1, [&*cell].into_iter());
            let _ = decimals.parse(&cell);
        }
    }
}
