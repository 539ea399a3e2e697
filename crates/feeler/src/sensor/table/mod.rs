//! Tables of text, as other programs write them.
//!
//! Comma, semicolon or tab separates cells, as in the header. Text is UTF-8 or UTF-16, lines end with LF, CR or both,
//! cells may be quoted. Lines that are blank or begin with `#` are comments, and a line `sep=;` before the header names the separator.
//! Columns are found by name, in any order, in whatever case: `Fx [N]` is `f_x` ([`Header::find`]). A unit in a column's name or in
//! the row below the header is obeyed ([`Quantity`]). Numbers have a decimal point or a decimal comma.
//!
//! What may be read in two ways is an error: both decimal marks in one table, a comma that may divide thousands, a column that may be
//! one of two, and a row with more or fewer cells than the header, as decimal commas make between commas.
//!
//! [`Table`] reads rows; what is sensed row by row without allocation ([`taxel`](super::taxel)) uses its parts.

mod cells;
mod encoding;
mod error;
mod header;
mod lines;
mod number;
mod rows;
mod unit;

pub(super) use cells::{Cells, separator_of};
pub use error::TableError;
pub use header::Header;
pub(super) use header::shortened;
pub use lines::MAX_LINE;
pub(super) use lines::{Line, Lines};
pub(super) use number::{Decimals, is_number};
pub use number::{Mark, NumberError};
pub use rows::{NumberColumn, Table};
pub use unit::Quantity;
pub(super) use unit::{are_units, is_no_unit, without_brackets};
