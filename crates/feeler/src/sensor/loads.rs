//! The file of loads that a calibration is fitted to: which picture was taken under which forces.
//!
//! CSV with the columns `picture, element, f_x, f_y, f_z` in any order, others ignored: a picture's
//! file, relative to the CSV; the index of an element; the force on it in its frame `E_i`, N. A
//! picture may have a row for each of several elements. A row of zero force says that the element was not
//! loaded; a row without an element (and without a force, or with a zero one) says so of all elements.
//! Of an element that has no row nothing is learned from the picture. Rows are taken to be in the
//! order in which the loads were put on.

use super::{
    calibration_fit::{ElementRecord, LoadSample},
    moments::ElementMoments,
};
use glam::DVec3;
use std::{collections::HashMap, io::Read};

/// The columns that there must be.
pub const COLUMNS: [&str; 5] = ["picture", "element", "f_x", "f_y", "f_z"];

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

/// Reads the loads of a fingertip of `elements` elements, picture by picture.
///
/// # Errors
/// Names line, field, value and what was expected.
pub fn read_loads(text: impl Read, elements: usize) -> Result<Vec<LoadedPicture>, LoadsError> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text);
    let header = reader.headers()?.clone();
    let mut columns = [0; COLUMNS.len()];
    for (place, column) in columns.iter_mut().zip(COLUMNS) {
        let found = header.iter().position(|name| name == column);
        *place = found.ok_or_else(|| LoadsError::Column {
            column,
            header: header.iter().collect::<Vec<_>>().join(","),
        })?;
    }
    let mut pictures: Vec<LoadedPicture> = Vec::new();
    let mut places = HashMap::new();
    let mut lines = HashMap::new();
    for record in reader.records() {
        let record = record?;
        let line = record.position().map_or(0, csv::Position::line);
        let [picture, element, x, y, z] = columns.map(|column| record.get(column).unwrap_or(""));
        let row = Row::parse(line, picture, element, [x, y, z], elements)?;
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

/// One row: a force on one element, or none on all of them.
struct Row {
    elements: std::ops::Range<usize>,
    force: DVec3,
}

impl Row {
    fn parse(
        line: u64,
        picture: &str,
        element: &str,
        force: [&str; 3],
        elements: usize,
    ) -> Result<Self, LoadsError> {
        let wrong = |field, value: &str, expected: &str| LoadsError::Field {
            line,
            field,
            value: value.to_owned(),
            expected: expected.to_owned(),
        };
        if picture.is_empty() {
            return Err(wrong("picture", picture, "the file of a picture"));
        }
        let mut newtons = [0.0; 3];
        for ((newton, text), field) in newtons.iter_mut().zip(force).zip(["f_x", "f_y", "f_z"]) {
            let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
            *newton = match number {
                Some(number) if element.is_empty() && number != 0.0 => {
                    return Err(wrong(field, text, "0 N or nothing, as no element is named"));
                }
                Some(number) => number,
                None if element.is_empty() && text.is_empty() => 0.0,
                None => return Err(wrong(field, text, "a finite number, N")),
            };
        }
        let elements = if element.is_empty() {
            0..elements
        } else {
            let index = element
                .parse::<usize>()
                .ok()
                .filter(|&index| index < elements);
            let expected = format!("an element from 0 to {}", elements.saturating_sub(1));
            let index = index.ok_or_else(|| wrong("element", element, &expected))?;
            index..index + 1
        };
        Ok(Self {
            elements,
            force: DVec3::from_array(newtons),
        })
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
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        read_loads(text.as_bytes(), 3).unwrap_err().to_string()
    }

    #[test]
    fn pictures_are_gathered_from_rows() {
        let text = "f_z,picture,element,f_x,f_y,note\n# no load\n0,a.png,,,0,\n1.5,b.png,2,0.1,-0.2,x\n0,b.png,0,0,0,\n";
        let pictures = read_loads(text.as_bytes(), 3).unwrap();
        assert_eq!(pictures[0].forces, [Some(DVec3::ZERO); 3]);
        let force = DVec3::new(0.1, -0.2, 1.5);
        assert_eq!(pictures[1].forces, [Some(DVec3::ZERO), None, Some(force)]);
        assert_eq!((pictures.len(), pictures[1].line), (2, 4));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let head = "picture,element,f_x,f_y,f_z\n";
        for (text, words) in [
            ("picture,element,f_x,f_y\n", "no column \"f_z\""),
            (head, "no loads"),
            ("", "no column"),
            ("picture,element,f_x,f_y,f_z\na,0,1,2\n", "line: 2"),
            (
                "picture,element,f_x,f_y,f_z\na,3,1,2,3\n",
                "line 2: element = \"3\"; expected an element from 0 to 2",
            ),
            (
                "picture,element,f_x,f_y,f_z\na,-1,1,2,3\n",
                "element = \"-1\"",
            ),
            (
                "picture,element,f_x,f_y,f_z\na,0,1,NaN,3\n",
                "line 2: f_y = \"NaN\"; expected a finite",
            ),
            ("picture,element,f_x,f_y,f_z\na,0,,2,3\n", "f_x = \"\""),
            (
                "picture,element,f_x,f_y,f_z\na,,0,0,3\n",
                "f_z = \"3\"; expected 0 N",
            ),
            ("picture,element,f_x,f_y,f_z\n,0,0,0,3\n", "picture = \"\""),
            (
                "picture,element,f_x,f_y,f_z\na,0,1,2,3\na,0,1,2,3\n",
                "already in line 2",
            ),
        ] {
            let message = refused(text);
            assert!(message.contains(words), "{message}");
        }
        let _ = read_loads(&b"\xff\xfe\n\xff,,"[..], 3).unwrap_err();
    }
}
