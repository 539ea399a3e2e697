//! Reads text tables (CSV and similar) written by other programs.
//!
//! Cells are separated by comma, semicolon or tab, detected from the header, and may be quoted. Text is UTF-8 or
//! UTF-16; lines end with LF, CR or both. Blank lines and lines that begin with `#` are comments. A line such as
//! `sep=;` before the header sets the separator. Columns are found by name, in any order and case: `Fx [N]` matches
//! `f_x` ([`Header::find`]). A unit in a column's name or in the row below the header is converted ([`Quantity`]).
//! Numbers have a decimal point or a decimal comma.
//!
//! Ambiguous input is an error: both decimal marks in one table, a comma that may be a thousands separator, several
//! columns that match a name, and a row whose number of cells differs from the header, as with decimal commas in
//! comma-separated cells.
//!
//! [`Table`] reads rows. Sensors that read row by row without allocation ([`taxel`](super::taxel)) use its parts.

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
