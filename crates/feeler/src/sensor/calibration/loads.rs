//! The CSV file of loads for a calibration: images and the forces under which they were taken.
//!
//! A [`table`](crate::sensor::table) with the columns `picture, element, f_x, f_y, f_z` in any order; other columns are
//! ignored. `picture` is an image file relative to the CSV, `element` the index of an element, and the force is given
//! in the element's frame `E_i`, N. An image may have one row for each of several elements. A row with zero force
//! means that the element was not loaded. A row without an element (and without a force or with zero force) means
//! that no element was loaded. Elements without a row are not used from that image. Rows are assumed to be in the
//! order of loading.
//!
//! If the table has the columns `column` and `row`, the position of the element in the image (px), elements are
//! identified by position, and `element` is an optional name. `x_angle` is the direction in the image of x of the
//! force's frame, rad ([`ProjectedElement::x_angle`]): forces are rotated from this frame to that of the layout's element.
//! Without `x_angle` they are assumed to be in the latter.

mod place;
mod records;

use super::live::ForceAxes;
use crate::sensor::image::seen::ProjectedElement;
use crate::sensor::table::{NumberColumn, NumberError, Quantity, Table, TableError};
use glam::{DVec2, DVec3};
use place::{NamedPlace, Places};
pub use records::{CapturedImage, RecordBuilder, records};
use std::{
    collections::HashMap,
    io::{BufRead, BufReader, Read},
    ops::Range,
};

/// Required columns.
pub const COLUMNS: [&str; 5] = ["picture", "element", "f_x", "f_y", "f_z"];

/// Optional columns: position of the element in the image, px, and direction of x of its frame, rad.
pub const PLACE_COLUMNS: [&str; 3] = ["column", "row", "x_angle"];

/// Error of reading loads.
#[derive(Debug, thiserror::Error)]
pub enum LoadsError {
    /// The table, or one of its rows, cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A required column is missing.
    #[error(
        "no column {column:?} in the header {header:?}, read with {separator} between cells; expected picture, element, f_x, f_y, f_z"
    )]
    Column {
        /// Name of the missing column.
        column: &'static str,
        /// Header of the table.
        header: String,
        /// Name of the separator between cells.
        separator: &'static str,
    },
    /// There are no rows.
    #[error("no loads: expected at least one row below the header")]
    Empty,
    /// A field is invalid.
    #[error("line {line}: {field} = {value:?}; expected {expected}")]
    Field {
        /// Line number in the file, from 1.
        line: u64,
        /// Name of the column.
        field: &'static str,
        /// Value found.
        value: String,
        /// Expected value.
        expected: String,
    },
    /// No element of the layout is near the position in the file.
    #[error(
        "line {line}: element {name:?} at column {}, row {}: the nearest element of the layout, {nearest}, is {distance:.1} px \
         away; expected less than {limit:.1} px, half the distance to its neighbour", place_px.x, place_px.y
    )]
    NoSuchPlace {
        /// Line number in the file, from 1.
        line: u64,
        /// Name of the element in the file.
        name: String,
        /// Position in the file, px.
        place_px: DVec2,
        /// Nearest element of the layout.
        nearest: usize,
        /// Distance of that element, px.
        distance: f64,
        /// Maximum allowed distance, px.
        limit: f64,
    },
    /// Elements of the file and of the layout do not correspond one to one.
    #[error(
        "line {line}: element {name:?} is at the place of element {element} of the layout, {before}; expected a different element of the \
         layout for each element of the file"
    )]
    SamePlace {
        /// Line number in the file, from 1.
        line: u64,
        /// Name of the element in the file.
        name: String,
        /// Index of the element in the layout.
        element: usize,
        /// Description of the earlier row that conflicts.
        before: String,
    },
    /// Two rows give a force for the same element in the same image.
    #[error(
        "line {line}: {picture:?} has a force for element {element} already in line {before}; expected one"
    )]
    Twice {
        /// Line number of the later row.
        line: u64,
        /// Line number of the earlier row.
        before: u64,
        /// Image file of both rows.
        picture: String,
        /// Index of the element.
        element: usize,
    },
}

/// One image and the forces on elements in it.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedImage {
    /// Path of the image as written in the CSV.
    pub picture: String,
    /// Line number of its first row.
    pub line: u64,
    /// Force on each element, N; `None` if the file does not specify it.
    pub forces: Vec<Option<DVec3>>,
}

/// Reads the loads of a fingertip whose elements have the positions `seen` in the image. Returns the images in order,
/// with forces in the frames of these elements. `axes` maps the columns, with signs, to x, y and z of an element.
///
/// # Errors
/// Returns the line, field, value and expected value of an invalid row, or the error of the table.
pub fn read_loads(
    text: impl Read,
    seen: &[ProjectedElement],
    axes: ForceAxes,
) -> Result<Vec<LoadedImage>, LoadsError> {
    let elements = seen.len();
    let mut table = Table::open(BufReader::new(text))?;
    let columns = Columns::of(&mut table)?;
    let mut by_place = Places::new(seen);
    let mut pictures: Vec<LoadedImage> = Vec::new();
    let mut places = HashMap::new();
    let mut lines = HashMap::new();
    while table.advance()? {
        let line = table.line();
        let row = Row::parse(&table, &columns, &mut by_place, axes)?;
        let picture = row.picture;
        let place = *places.entry(picture.clone()).or_insert_with(|| {
            pictures.push(LoadedImage {
                picture: picture.clone(),
                line,
                forces: vec![None; elements],
            });
            pictures.len() - 1
        });
        for element in row.elements {
            if let Some(before) = lines.insert((place, element), line) {
                return Err(LoadsError::Twice {
                    line,
                    before,
                    picture,
                    element,
                });
            }
            pictures[place].forces[element] = Some(row.force);
        }
    }
    if pictures.is_empty() {
        return Err(LoadsError::Empty);
    }
    Ok(pictures)
}

/// Column indices of the fields of a row.
struct Columns {
    picture: usize,
    element: Option<usize>,
    force: [NumberColumn; 3],
    /// Columns with the position of the element in the image; `None` unless the table has both.
    place: Option<[NumberColumn; 2]>,
    x_angle: Option<NumberColumn>,
}

impl Columns {
    fn of<R: BufRead>(table: &mut Table<R>) -> Result<Self, LoadsError> {
        let [picture, element, force @ ..] = COLUMNS;
        let [column, row, x_angle] = PLACE_COLUMNS;
        let place = table.number_column(column, Quantity::Pixels)?;
        let place = place.zip(table.number_column(row, Quantity::Pixels)?);
        let missing = |table: &Table<R>, column| LoadsError::Column {
            column,
            header: table.header().shown(),
            separator: table.separator(),
        };
        let picture = table
            .column(picture)?
            .ok_or_else(|| missing(table, picture))?;
        let element_column = table.column(element)?;
        if element_column.is_none() && place.is_none() {
            return Err(missing(table, element));
        }
        let mut axis = |name| {
            let column = table.number_column(name, Quantity::Force)?;
            column.ok_or_else(|| missing(table, name))
        };
        Ok(Self {
            picture,
            element: element_column,
            force: [axis(force[0])?, axis(force[1])?, axis(force[2])?],
            place: place.map(|(column, row)| [column, row]),
            x_angle: table.number_column(x_angle, Quantity::Angle)?,
        })
    }

    /// Returns whether the current row identifies no element, neither by name nor by position.
    fn name_none<R: BufRead>(&self, table: &Table<R>) -> bool {
        let mut place = self.place.iter().flatten();
        self.element
            .is_none_or(|element| table.text(element).is_empty())
            && place.all(|&column| table.number_text(column).is_empty())
    }
}

/// One row of the table.
struct Row {
    picture: String,
    elements: Range<usize>,
    force: DVec3,
}

impl Row {
    /// Parses the current row of `table`.
    fn parse<R: BufRead>(
        table: &Table<R>,
        columns: &Columns,
        by_place: &mut Places,
        axes: ForceAxes,
    ) -> Result<Self, LoadsError> {
        let field = Field { table };
        let picture = table.text(columns.picture).into_owned();
        if picture.is_empty() {
            return Err(field.wrong("picture", &picture, "the path of an image"));
        }
        let all = columns.name_none(table);
        let mut force = DVec3::ZERO;
        for (axis, (&column, name)) in columns.force.iter().zip(["f_x", "f_y", "f_z"]).enumerate() {
            let text = table.number_text(column);
            if all && text.is_empty() {
                continue;
            }
            force[axis] = field.number(name, column, "a finite number, N")?;
            if all && force[axis] != 0.0 {
                let expected = "0 N or an empty field, as no element is named";
                return Err(field.wrong(name, &text, expected));
            }
        }
        if all {
            let elements = 0..by_place.element_count();
            return Ok(Self {
                picture,
                elements,
                force,
            });
        }
        let element = element_of(&field, columns, by_place)?;
        force = axes.to_fingertip(force);
        let angle = columns
            .x_angle
            .filter(|&column| !table.number_text(column).is_empty());
        if let Some(column) = angle {
            let angle =
                field.number("x_angle", column, "a finite number, rad, or an empty field")?;
            force = by_place.turned(element, force, angle);
        }
        Ok(Self {
            picture,
            elements: element..element + 1,
            force,
        })
    }
}

/// Index of the row's element in the layout, identified by position if the file contains positions.
fn element_of<R: BufRead>(
    field: &Field<R>,
    columns: &Columns,
    by_place: &mut Places,
) -> Result<usize, LoadsError> {
    let table = field.table;
    let name = columns
        .element
        .map(|element| table.text(element))
        .unwrap_or_default();
    let Some([column, row]) = columns.place else {
        let count = by_place.element_count();
        let index = columns.element.and_then(|element| table.whole(element));
        let index = index
            .and_then(|index| usize::try_from(index).ok())
            .filter(|&index| index < count);
        let expected = format!("an element from 0 to {}", count.saturating_sub(1));
        return index.ok_or_else(|| field.wrong("element", &name, &expected));
    };
    let pixels = |name, column| {
        field.number(
            name,
            column,
            "a finite number, px, as the file has this column",
        )
    };
    let place_px = DVec2::new(pixels("column", column)?, pixels("row", row)?);
    by_place.find(NamedPlace {
        line: table.line(),
        name: &name,
        place_px,
    })
}

/// The current row, from which fields are parsed with error messages.
struct Field<'a, R> {
    table: &'a Table<R>,
}

impl<R: BufRead> Field<'_, R> {
    /// Parses the finite number in a column.
    fn number(
        &self,
        name: &'static str,
        column: NumberColumn,
        expected: &str,
    ) -> Result<f64, LoadsError> {
        let why = match self.table.number(column) {
            Ok(number) if number.is_finite() => return Ok(number),
            Ok(_) | Err(NumberError::NotANumber) => expected.to_owned(),
            Err(error) => format!("{expected}; {error}"),
        };
        Err(self.wrong(name, &self.table.number_text(column), &why))
    }

    fn wrong(&self, field: &'static str, value: &str, expected: &str) -> LoadsError {
        LoadsError::Field {
            line: self.table.line(),
            field,
            value: value.to_owned(),
            expected: expected.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests;
