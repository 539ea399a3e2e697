//! The file of loads that a calibration is fitted to: which picture was taken under which forces.
//!
//! CSV with the columns `picture, element, f_x, f_y, f_z` in any order, others ignored: a picture's
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

use super::{
    calibration_fit::{ElementRecord, LoadSample},
    moments::ElementMoments,
    seen::SeenElement,
};
use glam::{DVec2, DVec3};
use place::{NamedPlace, Places};
use std::{collections::HashMap, io::Read};

/// The columns that there must be.
pub const COLUMNS: [&str; 5] = ["picture", "element", "f_x", "f_y", "f_z"];

/// The columns that may be there beside them: where the element is seen, px, and where x of its frame points, rad.
pub const PLACE_COLUMNS: [&str; 3] = ["column", "row", "x_angle"];

/// Why loads cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LoadsError {
    /// The text is no CSV, or a row has too few or too many fields.
    #[error("not a CSV file: {0}; expected the columns picture, element, f_x, f_y, f_z")]
    Csv(#[from] csv::Error),
    /// A column is not in the header.
    #[error(
        "no column {column:?} in the header {header:?}; expected picture, element, f_x, f_y, f_z"
    )]
    Column {
        /// The column that is missing.
        column: &'static str,
        /// The header as it is.
        header: String,
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

/// Reads the loads of a fingertip whose elements the camera sees as `seen`, picture by picture; forces in the frames of these.
///
/// # Errors
/// Names line, field, value and what was expected.
pub fn read_loads(text: impl Read, seen: &[SeenElement]) -> Result<Vec<LoadedPicture>, LoadsError> {
    let elements = seen.len();
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text);
    let columns = Columns::of(reader.headers()?)?;
    let mut by_place = Places::new(seen);
    let mut pictures: Vec<LoadedPicture> = Vec::new();
    let mut places = HashMap::new();
    let mut lines = HashMap::new();
    for record in reader.records() {
        let record = record?;
        let line = record.position().map_or(0, csv::Position::line);
        let row = Row::parse(line, &columns.fields(&record), &mut by_place)?;
        let picture = row.picture;
        let place = *places.entry(picture.to_owned()).or_insert_with(|| {
            pictures.push(LoadedPicture {
                picture: picture.to_owned(),
                line,
                forces: vec![None; elements],
            });
            pictures.len() - 1
        });
        for element in row.elements {
            if let Some(before) = lines.insert((place, element), line) {
                let picture = picture.to_owned();
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
    always: [Option<usize>; COLUMNS.len()],
    place: [Option<usize>; PLACE_COLUMNS.len()],
}

impl Columns {
    fn of(header: &csv::StringRecord) -> Result<Self, LoadsError> {
        let find = |column: &str| header.iter().position(|name| name == column);
        let (always, mut place) = (COLUMNS.map(find), PLACE_COLUMNS.map(find));
        // A place is both.
        let has_place = place[0].is_some() && place[1].is_some();
        if !has_place {
            (place[0], place[1]) = (None, None);
        }
        let missing = always.into_iter().zip(COLUMNS);
        let mut missing =
            missing.filter(|&(at, column)| at.is_none() && !(has_place && column == "element"));
        match missing.next() {
            Some((_, column)) => Err(LoadsError::Column {
                column,
                header: header.iter().collect::<Vec<_>>().join(","),
            }),
            None => Ok(Self { always, place }),
        }
    }

    fn fields<'a>(&self, record: &'a csv::StringRecord) -> Fields<'a> {
        let field = |column: Option<usize>| record.get(column?);
        let [picture, element, x, y, z] =
            self.always.map(|column| field(column).unwrap_or_default());
        let [column, row, x_angle] = self.place.map(field);
        Fields {
            picture,
            element,
            force: [x, y, z],
            place: column.zip(row),
            x_angle: x_angle.unwrap_or_default(),
        }
    }
}

/// The texts of one row.
struct Fields<'a> {
    picture: &'a str,
    element: &'a str,
    force: [&'a str; 3],
    /// Column and row, where the file has them.
    place: Option<(&'a str, &'a str)>,
    x_angle: &'a str,
}

impl Fields<'_> {
    /// Whether the row speaks of all elements.
    fn names_none(&self) -> bool {
        self.element.is_empty() && self.place.is_none_or(|place| place == ("", ""))
    }
}

/// One row: a force on one element, or none on all of them.
struct Row<'a> {
    picture: &'a str,
    elements: std::ops::Range<usize>,
    force: DVec3,
}

impl<'a> Row<'a> {
    fn parse(line: u64, fields: &Fields<'a>, by_place: &mut Places) -> Result<Self, LoadsError> {
        let picture = fields.picture;
        if picture.is_empty() {
            return Err(wrong(line, "picture", picture, "the file of a picture"));
        }
        let all = fields.names_none();
        let mut newtons = [0.0; 3];
        let components = fields.force.into_iter().zip(["f_x", "f_y", "f_z"]);
        for (newton, (text, field)) in newtons.iter_mut().zip(components) {
            *newton = match number(text) {
                Some(number) if all && number != 0.0 => {
                    let expected = "0 N or nothing, as no element is named";
                    return Err(wrong(line, field, text, expected));
                }
                Some(number) => number,
                None if all && text.is_empty() => 0.0,
                None => return Err(wrong(line, field, text, "a finite number, N")),
            };
        }
        let force = DVec3::from_array(newtons);
        if all {
            let elements = 0..by_place.element_count();
            return Ok(Self {
                picture,
                elements,
                force,
            });
        }
        let element = element_of(line, fields, by_place)?;
        let turned = match (fields.x_angle, number(fields.x_angle)) {
            ("", _) => force,
            (_, Some(angle)) => by_place.turned(element, force, angle),
            (text, None) => {
                return Err(wrong(
                    line,
                    "x_angle",
                    text,
                    "a finite number, rad, or nothing",
                ));
            }
        };
        Ok(Self {
            picture,
            elements: element..element + 1,
            force: turned,
        })
    }
}

/// The layout's element that a row speaks of, by its place if the file has places.
fn element_of(line: u64, fields: &Fields, by_place: &mut Places) -> Result<usize, LoadsError> {
    let name = fields.element;
    let Some((column, row)) = fields.place else {
        let count = by_place.element_count();
        let index = name.parse::<usize>().ok().filter(|&index| index < count);
        let expected = format!("an element from 0 to {}", count.saturating_sub(1));
        return index.ok_or_else(|| wrong(line, "element", name, &expected));
    };
    let pixels = |field, text| {
        let expected = "a finite number, px, as there is a column for it";
        number(text).ok_or_else(|| wrong(line, field, text, expected))
    };
    let place_px = DVec2::new(pixels("column", column)?, pixels("row", row)?);
    by_place.find(NamedPlace {
        line,
        name,
        place_px,
    })
}

fn number(text: &str) -> Option<f64> {
    text.parse::<f64>().ok().filter(|number| number.is_finite())
}

fn wrong(line: u64, field: &'static str, value: &str, expected: &str) -> LoadsError {
    LoadsError::Field {
        line,
        field,
        value: value.to_owned(),
        expected: expected.to_owned(),
    }
}

/// What is known of each element from pictures and their moments, for a fit.
///
/// All loads are both fitted and looked at for repetitions; errors are found by cross-validation.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordBuilder {
    records: Vec<ElementRecord>,
}

impl RecordBuilder {
    /// For `elements` elements.
    pub fn new(elements: usize) -> Self {
        Self {
            records: vec![ElementRecord::default(); elements],
        }
    }

    /// Adds a picture's forces and the moments of all elements in it, from wherever they come.
    pub fn add(&mut self, forces: &[Option<DVec3>], moments: &[ElementMoments]) {
        for ((record, force), &moments) in self.records.iter_mut().zip(forces).zip(moments) {
            let Some(force) = *force else { continue };
            let sample = LoadSample { force, moments };
            if force == DVec3::ZERO {
                record.unloaded.push(moments);
            } else {
                record.fitted.push(sample);
            }
            record.cycled.push(sample);
        }
    }

    /// The records, one for each element.
    pub fn finish(self) -> Vec<ElementRecord> {
        self.records
    }
}

#[cfg(test)]
mod tests;
