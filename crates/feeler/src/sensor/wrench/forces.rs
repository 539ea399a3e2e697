//! Reads tables of measured wrenches: the total force and torque at the time of each image.
//!
//! A [`table`](crate::sensor::table) with a column `picture` (a file relative to the CSV, or `FILE@TIME` for the frame
//! of a recording or video at a time in s), or instead with columns `recording` (an .mcap file or a video) and `time`
//! (s). The table has at least one of the columns `f_x, f_y, f_z` (N), `m_x, m_y, m_z` (N·m) and `p_x, p_y` (place of
//! contact, m), in any order; other columns are ignored. A cell is empty if nothing was measured. A column `recording`
//! next to `picture` groups the images; without it, images are grouped by name ([`recordings`](super::recordings)).

use super::recordings::{number_names, recordings};
use super::{AXES, MeasuredWrench, WrenchAxis};
use crate::sensor::table::{NumberColumn, NumberError, Quantity, Table, TableError};
use std::io::{BufRead, BufReader, Read};

/// Error of reading measured wrenches.
#[derive(Debug, thiserror::Error)]
pub enum ForcesError {
    /// The table or one of its rows cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The header lacks a column.
    #[error(
        "no column {column} in the header {header:?}, read with {separator} between cells; expected picture (or recording, time) and \
         at least one of f_x, f_y, f_z, m_x, m_y, m_z, p_x, p_y"
    )]
    Column {
        /// Name of the missing column.
        column: &'static str,
        /// The actual header.
        header: String,
        /// Name of the separator between cells.
        separator: &'static str,
    },
    /// The table has no rows.
    #[error("no forces: expected at least one row below the header")]
    Empty,
    /// A cell is invalid.
    #[error("line {line}: {field} = {value:?}; expected {expected}")]
    Field {
        /// Line number in the file, from 1.
        line: u64,
        /// Name of the column.
        field: &'static str,
        /// Value found.
        value: String,
        /// Description of valid values.
        expected: String,
    },
}

/// One row: an image and the wrench measured when it was taken.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPicture {
    /// Name of the image file, or `FILE@TIME`, as in the CSV.
    pub picture: String,
    /// Line number of the row.
    pub line: u64,
    /// Index of the recording.
    pub recording: usize,
    /// Time of the image, s, or `None` if unknown.
    pub time: Option<f64>,
    /// Measured wrench.
    pub wrench: MeasuredWrench,
}

/// All rows, in order of time within each recording.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredForces {
    /// Names of the recordings.
    pub recordings: Vec<String>,
    /// The images, by recording and in order of time.
    pub pictures: Vec<MeasuredPicture>,
}

/// Column indices of the fields of a row.
struct Columns {
    picture: Option<usize>,
    recording: Option<usize>,
    time: Option<NumberColumn>,
    axes: [Option<NumberColumn>; AXES],
}

impl Columns {
    fn of<R: BufRead>(table: &mut Table<R>) -> Result<Self, ForcesError> {
        let mut axes = [None; AXES];
        for (found, axis) in axes.iter_mut().zip(WrenchAxis::ALL) {
            *found = table.number_column(axis.name(), axis.quantity())?;
        }
        let columns = Self {
            picture: table.column("picture")?,
            recording: table.column("recording")?,
            time: table.number_column("time", Quantity::Time)?,
            axes,
        };
        let missing = |column| ForcesError::Column {
            column,
            header: table.header().shown(),
            separator: table.separator(),
        };
        match columns {
            Self {
                picture: None,
                recording: None,
                ..
            } => Err(missing("picture")),
            Self {
                picture: None,
                time: None,
                ..
            } => Err(missing("time")),
            Self { axes, .. } if axes.iter().all(Option::is_none) => Err(missing("f_x")),
            columns => Ok(columns),
        }
    }

    /// Name of the image in the current row.
    fn picture<R: BufRead>(
        &self,
        table: &Table<R>,
        time: Option<f64>,
    ) -> Result<String, ForcesError> {
        let text =
            |column: Option<usize>| column.map(|column| table.text(column)).unwrap_or_default();
        let picture = match (self.picture, time) {
            (None, Some(time)) => format!("{}@{time}", text(self.recording)),
            _ => text(self.picture).into_owned(),
        };
        if !picture.is_empty() && !picture.starts_with('@') {
            return Ok(picture);
        }
        Err(ForcesError::Field {
            line: table.line(),
            field: if self.picture.is_some() {
                "picture"
            } else {
                "recording"
            },
            value: text(self.picture).into_owned(),
            expected: "an image file or a recording".into(),
        })
    }
}

/// Reads a table of measured wrenches.
///
/// # Errors
/// Returns [`ForcesError`] with line, field, value and the expected values.
pub fn read_forces(text: impl Read) -> Result<MeasuredForces, ForcesError> {
    let mut table = Table::open(BufReader::new(text))?;
    let columns = Columns::of(&mut table)?;
    let mut pictures = Vec::new();
    let mut named = Vec::new();
    while table.advance()? {
        let time = match columns.time {
            Some(time) if columns.picture.is_none() => Some(number(&table, "time", time)?),
            Some(time) => table.number(time).ok().filter(|time| time.is_finite()),
            None => None,
        };
        let picture = columns.picture(&table, time)?;
        let mut wrench = [None; AXES];
        for ((value, column), axis) in wrench.iter_mut().zip(columns.axes).zip(WrenchAxis::ALL) {
            let column = column.filter(|&column| !table.number_text(column).is_empty());
            *value = column
                .map(|column| number(&table, axis.name(), column))
                .transpose()?;
        }
        let recording = columns.recording.map(|column| table.text(column));
        named.push(recording.unwrap_or_default().into_owned());
        pictures.push(MeasuredPicture {
            picture,
            line: table.line(),
            recording: 0,
            time,
            wrench,
        });
    }
    if pictures.is_empty() {
        return Err(ForcesError::Empty);
    }
    let by_name = columns.recording.is_none();
    Ok(in_order(pictures, by_name, &named))
}

/// Sorts the rows by recording and time.
fn in_order(mut pictures: Vec<MeasuredPicture>, by_name: bool, named: &[String]) -> MeasuredForces {
    let (numbered_names, by_names) = recordings(pictures.iter().map(|p| p.picture.as_str()));
    let numbers = by_names.iter().map(|&(_, number)| number);
    let (recordings, of) = match by_name {
        true => (numbered_names, by_names.iter().map(|&(of, _)| of).collect()),
        false => number_names(named.iter().map(String::as_str)),
    };
    for (picture, &of) in pictures.iter_mut().zip(&of) {
        picture.recording = of;
    }
    let timed = pictures.iter().all(|picture| picture.time.is_some());
    let times = pictures.iter().map(|picture| picture.time);
    let keys: Vec<_> = times.zip(numbers).collect();
    let mut order: Vec<_> = (0..pictures.len()).collect();
    order.sort_by(|&a, &b| {
        let time = |row: usize| keys[row].0.filter(|_| timed).unwrap_or(0.0);
        let times = time(a).total_cmp(&time(b));
        of[a]
            .cmp(&of[b])
            .then(times)
            .then(keys[a].1.cmp(&keys[b].1))
    });
    MeasuredForces {
        recordings,
        pictures: order.into_iter().map(|row| pictures[row].clone()).collect(),
    }
}

/// Parses the number in a column of the current row.
fn number<R: BufRead>(
    table: &Table<R>,
    field: &'static str,
    column: NumberColumn,
) -> Result<f64, ForcesError> {
    /// Maximum absolute value of a number: far above any force or time and far below overflow of sums of squares.
    const LARGEST: f64 = 1e12;
    const EXPECTED: &str = "a finite number, or an empty cell if not measured";
    let expected = match table.number(column) {
        Ok(number) if number.abs() <= LARGEST => return Ok(number),
        Ok(_) | Err(NumberError::NotANumber) => EXPECTED.into(),
        Err(error) => format!("{EXPECTED}; {error}"),
    };
    Err(ForcesError::Field {
        line: table.line(),
        field,
        value: table.number_text(column).into_owned(),
        expected,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn rows_are_gathered_by_recording_in_the_order_of_time() {
        let text =
            "f_z,picture,f_x\n-1,b_10.png,0.5\n,b_9.png,\n# note\n2,a_3.png,1\n3,a_1.png,1\n";
        let forces = read_forces(text.as_bytes()).unwrap();
        assert_eq!(forces.recordings, ["b", "a"]);
        let names: Vec<_> = forces.pictures.iter().map(|p| &*p.picture).collect();
        assert_eq!(names, ["b_9.png", "b_10.png", "a_1.png", "a_3.png"]);
        assert_eq!(forces.pictures[0].wrench, [None; AXES]);
        let [x, y, z, ..] = forces.pictures[1].wrench;
        assert_eq!(
            (x, y, z, forces.pictures[1].line),
            (Some(0.5), None, Some(-1.0), 2)
        );
        let text = "Recording;Time [ms];Torque Z [mNm]\nx.mcap;1500;2,5\n";
        let forces = read_forces(text.as_bytes()).unwrap();
        assert_eq!(forces.pictures[0].picture, "x.mcap@1.5");
        assert_eq!(forces.pictures[0].wrench[5], Some(0.0025));
        let text = "recording,time,m_z\nx.mcap,2.5,1\nx.mcap,1.5,2\n";
        let forces = read_forces(text.as_bytes()).unwrap();
        assert_eq!(forces.pictures[0].picture, "x.mcap@1.5");
    }

    #[test]
    fn errors_name_the_problem() {
        for (text, words) in [
            ("f_x\n1\n", "no column picture"),
            ("recording,f_x\na,1\n", "no column time"),
            ("picture,force\na,1\n", "no column f_x"),
            (
                "picture,f_x,f_x\na,1,2\n",
                "columns \"f_x\", \"f_x\" may all be f_x",
            ),
            (
                "picture,Mx [N]\na,1\n",
                "column \"Mx [N]\" is in \"N\"; expected Nm",
            ),
            ("picture,f_x\na,0,5\n", "if numbers have decimal commas"),
            ("picture,f_x\n", "no forces"),
            (
                "picture,f_x\na,inf\n",
                "line 2: f_x = \"inf\"; expected a finite",
            ),
            ("picture,f_x\na,1 N\n", "f_x = \"1 N\""),
            ("picture,f_x\n,1\n", "picture = \"\""),
            ("recording,time,f_x\na.mcap,,1\n", "time = \"\""),
            ("picture,f_x\na\n", "line 2: 1 cells; expected 2"),
        ] {
            let message = read_forces(text.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }

    proptest! {
        /// Arbitrary text is either read, in order, or rejected.
        #[test]
        fn hostile_text_is_read_or_refused(text in "(picture|recording|f_x|time|[a-z0-9,\n\"#.@/ -]){0,40}") {
            if let Ok(forces) = read_forces(text.as_bytes()) {
                prop_assert!(forces.pictures.windows(2).all(|p| p[0].recording <= p[1].recording));
                prop_assert!(forces.pictures.iter().all(|p| p.recording < forces.recordings.len()));
            }
        }
    }
}
