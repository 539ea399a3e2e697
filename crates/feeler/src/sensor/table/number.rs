//! Parses numbers in cells, with a decimal point or a decimal comma.

/// Error of parsing a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NumberError {
    /// The cell is not a number.
    #[error("not a number")]
    NotANumber,
    /// The decimal mark could be a thousands separator.
    #[error(
        "its {0} may be a decimal {0} or a thousands separator; expected another cell that shows which, such as {example}", example = .0.example()
    )]
    Thousands(Mark),
    /// The decimal mark differs from that of the first unambiguous number in the table.
    #[error(
        "it has a decimal {own}, but line {line} has a decimal {other}; expected the same mark in all lines"
    )]
    Mixed {
        /// Decimal mark of this cell.
        own: Mark,
        /// Decimal mark of that number.
        other: Mark,
        /// Line of that number, from 1.
        line: u64,
    },
}

/// Decimal mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Decimal point, `.`.
    Point,
    /// Decimal comma, `,`.
    Comma,
}

impl Mark {
    fn byte(self) -> u8 {
        match self {
            Self::Point => b'.',
            Self::Comma => b',',
        }
    }

    /// Example of an unambiguous number with this mark, for messages.
    fn example(self) -> &'static str {
        match self {
            Self::Point => "0.5",
            Self::Comma => "0,5",
        }
    }
}

impl std::fmt::Display for Mark {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Point => "point",
            Self::Comma => "comma",
        })
    }
}

/// Maximum length of a number, bytes.
const LONGEST: usize = 64;

/// Parses numbers with the decimal mark of the first unambiguous number in the table. Does not allocate.
#[derive(Debug, Clone, Copy)]
pub struct Decimals {
    mark: Option<(Mark, u64)>,
    /// `true` if a point could be a thousands separator.
    points_divide: bool,
}

impl Decimals {
    /// Creates a parser for a table with this `separator` between cells. If it is a semicolon, a point could be a
    /// thousands separator, because semicolons are used if commas are decimal marks.
    pub fn new(separator: u8) -> Self {
        Self {
            mark: None,
            points_divide: separator == b';',
        }
    }

    /// Detects the decimal mark from the numeric cells of `line`, unless it is already known.
    pub fn look<'a>(&mut self, line: u64, mut cells: impl Iterator<Item = &'a [u8]>) {
        if self.mark.is_none() {
            let mark = cells.find_map(|cell| self.clear_mark(cell));
            self.mark = mark.map(|mark| (mark, line));
        }
    }

    /// Parses the number in a cell.
    ///
    /// # Errors
    /// If the cell is not a number, or is ambiguous.
    pub fn parse(&self, cell: &[u8]) -> Result<f64, NumberError> {
        let (number, own) = number(cell).ok_or(NumberError::NotANumber)?;
        let Some(own) = own else { return Ok(number) };
        match self.mark {
            Some((other, line)) if other != own => Err(NumberError::Mixed { own, other, line }),
            None if self.is_prone_to_overfitting(cell, own) => Err(NumberError::Thousands(own)),
            _ => Ok(number),
        }
    }

    /// Decimal mark of the number in a cell, or `None` if it has none or is ambiguous.
    fn clear_mark(&self, cell: &[u8]) -> Option<Mark> {
        let (_, mark) = number(cell)?;
        mark.filter(|&mark| !self.is_prone_to_overfitting(cell, mark))
    }

    fn is_prone_to_overfitting(&self, cell: &[u8], mark: Mark) -> bool {
        (mark == Mark::Comma || self.points_divide) && may_divide_thousands(cell, mark)
    }
}

/// Returns `true` if a cell contains a number with either decimal mark.
pub fn is_number(cell: &[u8]) -> bool {
    number(cell).is_some()
}

/// Parses the number in a cell. Returns it with its decimal mark, if any.
fn number(cell: &[u8]) -> Option<(f64, Option<Mark>)> {
    let mut text = [0; LONGEST];
    let text = text.get_mut(..cell.len())?;
    text.copy_from_slice(cell);
    // A typographic minus sign.
    let text = match text.strip_prefix("\u{2212}".as_bytes()).map(<[u8]>::len) {
        Some(digits) => {
            let start = text.len() - digits - 1;
            text[start] = b'-';
            &mut text[start..]
        }
        None => text,
    };
    let comma = text.iter().position(|&byte| byte == b',');
    let mark = match comma {
        // A number cannot contain a comma and a point, or two commas.
        Some(_) if text.contains(&b'.') => return None,
        Some(place) => {
            text[place] = b'.';
            Some(Mark::Comma)
        }
        None => text.contains(&b'.').then_some(Mark::Point),
    };
    Some((str::from_utf8(text).ok()?.parse().ok()?, mark))
}

/// Returns `true` if a number's mark could be a thousands separator: one to three digits before it, not starting with
/// 0, and three after it.
fn may_divide_thousands(cell: &[u8], mark: Mark) -> bool {
    let signs = [b"-", b"+", "\u{2212}".as_bytes()];
    let digits = signs.iter().find_map(|sign| cell.strip_prefix(*sign));
    let digits = digits.unwrap_or(cell);
    let Some(place) = digits.iter().position(|&byte| byte == mark.byte()) else {
        return false;
    };
    let (before, behind) = (&digits[..place], &digits[place + 1..]);
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
        read_between(b',', rows)
    }

    fn read_between(separator: u8, rows: &[&str]) -> Vec<Result<f64, NumberError>> {
        let mut decimals = Decimals::new(separator);
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
    fn accepts_either_mark_but_not_both() {
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
    fn rejects_a_comma_that_may_separate_thousands() {
        let doubtful = |mark| [Err(NumberError::Thousands(mark))];
        assert_eq!(read(&["1,234"]), doubtful(Mark::Comma));
        assert_eq!(read(&["-12,345"]), doubtful(Mark::Comma));
        assert_eq!(read(&["\u{2212}12,345"]), doubtful(Mark::Comma));
        // Disambiguated by another cell in the same or an earlier row.
        assert_eq!(read(&["1,234;0,5"]), [Ok(1.234), Ok(0.5)]);
        assert_eq!(read(&["1234,567", "1,234"]), [Ok(1234.567), Ok(1.234)]);
        assert_eq!(read(&["0,512"]), [Ok(0.512)]);
        // A point is ambiguous only if commas may be decimal marks.
        assert_eq!(read(&["1.234"]), [Ok(1.234)]);
        let between_semicolons = |rows: &[&str]| read_between(b';', rows);
        assert_eq!(between_semicolons(&["1.234"]), doubtful(Mark::Point));
        assert_eq!(between_semicolons(&["1.234;0.5"]), [Ok(1.234), Ok(0.5)]);
        assert!(matches!(
            between_semicolons(&["0,5", "1.234"])[1],
            Err(NumberError::Mixed { .. })
        ));
    }

    #[test]
    fn a_typeset_minus_is_a_minus() {
        assert_eq!(read(&["\u{2212}0.5"]), [Ok(-0.5)]);
        assert_eq!(read(&["\u{2212}0,5"]), [Ok(-0.5)]);
        for none in ["\u{2212}", "\u{2212}-1", "1\u{2212}", "-\u{2212}1"] {
            assert_eq!(read(&[none]), [Err(NumberError::NotANumber)], "{none}");
        }
    }

    proptest! {
        /// A number with a comma equals the number with a point, bit for bit.
        #[test]
        fn a_comma_changes_no_bit(number in -1e9..1e9) {
            let text = f64::to_string(&number).replace('.', ",");
            prop_assert_eq!(read(&["0,5", &text])[1], Ok(number));
        }

        #[test]
        fn any_cell_is_read_or_refused(cell in proptest::collection::vec(any::<u8>(), 0..80)) {
            let mut decimals = Decimals::new(b';');
            decimals.look(1, [&*cell].into_iter());
            let _ = decimals.parse(&cell);
        }
    }
}
