//! The file of loads that a calibration is fitted to: which picture was taken under which forces.
//!
//! A [`table`](super::table) with the columns `picture, element, f_x, f_y, f_z` in any order, others ignored: a picture's
//! file, relative to the CSV; the index of an element; the force on it in its frame `E_i`, N. A
//! picture may have a row for each of several elements. A row of zero force says that the element was not
//! loaded; a row without an element (and without a force, or with a zero one) says so of all elements.
//! Of an element that has no row nothing is learned from the picture. Rows are taken to be in the
//! order in which the loads were put on.
//!
//! With the columns `column` and `row`, where the element is seen (px), elements are told by their places, and `element` is a
//! name, which may be missing. `x_angle` is where x of the frame of the force points in the picture, rad
//! ([`SeenElement::x_angle`]): forces are turned from there into the frame of the layout's element, and are taken to be in
//! that where it is missing.

mod place;
mod records;

use super::{
    live_calibration::ForceAxes,
    seen::SeenElement,
    table::{NumberColumn, NumberError, Quantity, Table, TableError},
};
use glam::{DVec2, DVec3};
use place::{NamedPlace, Places};
pub use records::{RecordBuilder, TakenPicture, records};
use std::{
    collections::HashMap,
    io::{BufRead, BufReader, Read},
    ops::Range,
};

/// The columns that there must be.
pub const COLUMNS: [&str; 5] = ["picture", "element", "f_x", "f_y", "f_z"];

/// The columns that may be there beside them: where the element is seen, px, and where x of its frame points, rad.
pub const PLACE_COLUMNS: [&str; 3] = ["column", "row", "x_angle"];

/// Why loads cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LoadsError {
    /// The table, or a row of it, cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A column is not in the header.
    #[error(
        "no column {column:?} in the header {header:?}, read with {separator} between cells; expected picture, element, f_x, f_y, f_z"
    )]
    Column {
        /// The column that is missing.
        column: &'static str,
        /// The header as it is.
        header: String,
        /// What stands between its cells, in words.
        separator: &'static str,
    },
    /// There are no rows.
    #[error("no loads: at least one row expected below the header")]
    Empty,
    /// A field cannot be used.
    #[error("line {line}: {field} = {value:?}; expected {expected}")]
    Field {
        /// Line in the file, from 1.
        line: u64,
        /// The column.
        field: &'static str,
        /// What stands there.
        value: String,
        /// What should.
        expected: String,
    },
    /// There is no element where one is said to be.
    #[error(
        "line {line}: element {name:?} at column {}, row {}: the nearest element of the layout, {nearest}, is {distance:.1} px \
         away; expected less than {limit:.1} px, half the distance to its neighbour", place_px.x, place_px.y
    )]
    NoSuchPlace {
        /// Line in the file, from 1.
        line: u64,
        /// What the file calls the element.
        name: String,
        /// Its place, px.
        place_px: DVec2,
        /// The nearest element of the layout.
        nearest: usize,
        /// How far that is away, px.
        distance: f64,
        /// How far it may be, px.
        limit: f64,
    },
    /// An element of the file is two of the layout, or two of the file are one of the layout.
    #[error(
        "line {line}: element {name:?} is at the place of element {element} of the layout, {before}; expected one element of the \
         layout for each"
    )]
    SamePlace {
        /// Line in the file, from 1.
        line: u64,
        /// What the file calls the element.
        name: String,
        /// Number in the layout.
        element: usize,
        /// What an earlier row says, in words.
        before: String,
    },
    /// Two rows speak of the same element in the same picture.
    #[error("line {line}: {picture:?} has a force for element {element} already in line {before}")]
    Twice {
        /// The later line.
        line: u64,
        /// The earlier line.
        before: u64,
        /// The picture.
        picture: String,
        /// The element.
        element: usize,
    },
}

/// One picture and the forces on elements in it.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedPicture {
    /// File of the picture, as it stands in the CSV.
    pub picture: String,
    /// Line of its first row.
    pub line: u64,
    /// Force on each element, N; none where nothing is said of it.
    pub forces: Vec<Option<DVec3>>,
}

/// Reads the loads of a fingertip whose elements the camera sees as `seen`, picture by picture; forces in the frames of these. `axes` are
/// the columns, with their signs, that are x, y and z of an element.
///
/// # Errors
/// Names line, field, value and what was expected.
pub fn read_loads(
    text: impl Read,
    seen: &[SeenElement],
    axes: ForceAxes,
) -> Result<Vec<LoadedPicture>, LoadsError> {
    let elements = seen.len();
    let mut table = Table::open(BufReader::new(text))?;
    let columns = Columns::of(&mut table)?;
    let mut by_place = Places::new(seen);
    let mut pictures: Vec<LoadedPicture> = Vec::new();
    let mut places = HashMap::new();
    let mut lines = HashMap::new();
    while table.advance()? {
        let line = table.line();
        let row = Row::parse(&table, &columns, &mut by_place, axes)?;
        let picture = row.picture;
        let place = *places.entry(picture.clone()).or_insert_with(|| {
            pictures.push(LoadedPicture {
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

/// Where in a row the fields are.
struct Columns {
    picture: usize,
    element: Option<usize>,
    force: [NumberColumn; 3],
    /// Column and row of a place; `None` unless the table has both.
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

    /// Whether nothing of a row says of which element it is.
    fn name_none<R: BufRead>(&self, table: &Table<R>) -> bool {
        let mut place = self.place.iter().flatten();
        self.element
            .is_none_or(|element| table.text(element).is_empty())
            && place.all(|&column| table.number_text(column).is_empty())
    }
}

/// One row.
struct Row {
    picture: String,
    elements: Range<usize>,
    force: DVec3,
}

impl Row {
    /// The newest row of `table`.
    fn parse<R: BufRead>(
        table: &Table<R>,
        columns: &Columns,
        by_place: &mut Places,
        axes: ForceAxes,
    ) -> Result<Self, LoadsError> {
        let field = Field { table };
        let picture = table.text(columns.picture).into_owned();
        if picture.is_empty() {
            return Err(field.wrong("picture", &picture, "the file of a picture"));
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
                let expected = "0 N or nothing, as no element is named";
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
            let angle = field.number("x_angle", column, "a finite number, rad, or nothing")?;
            force = by_place.turned(element, force, angle);
        }
        Ok(Self {
            picture,
            elements: element..element + 1,
            force,
        })
    }
}

/// The layout's element that a row is about, by its place if the file has places.
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
            "a finite number, px, as there is a column for it",
        )
    };
    let place_px = DVec2::new(pixels("column", column)?, pixels("row", row)?);
    by_place.find(NamedPlace {
        line: table.line(),
        name: &name,
        place_px,
    })
}

/// The newest row of a table, whose fields may be wrong.
struct Field<'a, R> {
    table: &'a Table<R>,
}

impl<R: BufRead> Field<'_, R> {
    /// The finite number in a column.
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
