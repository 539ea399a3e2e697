//! The file of measured wrenches: which picture was taken under which total force and torque.
//!
//! CSV with a column `picture` (a file, relative to the CSV; or `FILE.mcap@TIME`, the frame of a recording at a time in s), or with
//! `recording` (an .mcap file) and `time` (s) instead; and at least one of `f_x, f_y, f_z` (N) and `m_x, m_y, m_z` (N m), in any order,
//! others ignored. A cell is empty where nothing was measured. A column `recording` beside `picture` says which pictures belong
//! together; without one, names do ([`recordings`](super::recordings)).

use super::recordings::{number_names, recordings};
use super::{AXES, MeasuredWrench, WrenchAxis};
use std::io::Read;

/// Why measured wrenches cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ForcesError {
    /// The text is no CSV, or a row has too few or too many fields.
    #[error(
        "not a CSV file: {0}; expected the columns picture (or recording, time) and f_x, f_y, f_z, m_x, m_y, m_z or some of them"
    )]
    Csv(#[from] csv::Error),
    /// A column is not in the header.
    #[error(
        "no column {column} in the header {header:?}; expected picture (or recording, time) and f_x, f_y, f_z, m_x, m_y, m_z or some of them"
    )]
    Column {
        /// The column that is missing.
        column: &'static str,
        /// The header as it is.
        header: String,
    },
    /// A column is there twice.
    #[error("column {column:?} is twice in the header; expected once")]
    ColumnTwice {
        /// The column.
        column: String,
    },
    /// There are no rows.
    #[error("no forces: at least one row expected below the header")]
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
        expected: &'static str,
    },
}

/// One row: a picture and what was measured when it was taken.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPicture {
    /// File of the picture, or `FILE.mcap@TIME`, as it stands in the CSV.
    pub picture: String,
    /// Line of the row.
    pub line: u64,
    /// Index of the recording that it is part of.
    pub recording: usize,
    /// What was measured.
    pub wrench: MeasuredWrench,
}

/// All rows, in the order of time within each recording.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredForces {
    /// Name of each recording.
    pub recordings: Vec<String>,
    /// The pictures, recording by recording.
    pub pictures: Vec<MeasuredPicture>,
}

/// Where the columns are.
struct Columns {
    picture: Option<usize>,
    recording: Option<usize>,
    time: Option<usize>,
    axes: [Option<usize>; AXES],
}

impl Columns {
    fn of(header: &csv::StringRecord) -> Result<Self, ForcesError> {
        let place = |column: &str| -> Result<Option<usize>, ForcesError> {
            let mut found = header
                .iter()
                .enumerate()
                .filter(|(_, name)| *name == column);
            match (found.next(), found.next()) {
                (_, Some(_)) => Err(ForcesError::ColumnTwice {
                    column: column.into(),
                }),
                (first, None) => Ok(first.map(|(place, _)| place)),
            }
        };
        let mut axes = [None; AXES];
        for (found, axis) in axes.iter_mut().zip(WrenchAxis::ALL) {
            *found = place(axis.name())?;
        }
        let columns = Self {
            picture: place("picture")?,
            recording: place("recording")?,
            time: place("time")?,
            axes,
        };
        let missing = |column| ForcesError::Column {
            column,
            header: header.iter().collect::<Vec<_>>().join(","),
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
}

/// Reads measured wrenches.
///
/// # Errors
/// Names line, field, value and what was expected.
pub fn read_forces(text: impl Read) -> Result<MeasuredForces, ForcesError> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text);
    let columns = Columns::of(&reader.headers()?.clone())?;
    let mut pictures = Vec::new();
    let mut named = Vec::new();
    let mut times = Vec::new();
    for record in reader.records() {
        let record = record?;
        let line = record.position().map_or(0, csv::Position::line);
        let field = |column: Option<usize>| column.and_then(|c| record.get(c)).unwrap_or("");
        let recording = field(columns.recording);
        let time = match columns.time.map(|_| field(columns.time)) {
            Some(time) if columns.picture.is_none() => Some(number(line, "time", time)?),
            Some(time) => time.parse().ok().filter(|time: &f64| time.is_finite()),
            None => None,
        };
        let picture = match (columns.picture, time) {
            (None, Some(time)) => format!("{recording}@{time}"),
            _ => field(columns.picture).to_owned(),
        };
        let what = if columns.picture.is_some() {
            "picture"
        } else {
            "recording"
        };
        if picture.is_empty() || picture.starts_with('@') {
            return Err(wrong(
                line,
                what,
                field(columns.picture),
                "the file of a picture or a recording",
            ));
        }
        let mut wrench = [None; AXES];
        for ((value, column), axis) in wrench.iter_mut().zip(columns.axes).zip(WrenchAxis::ALL) {
            let text = field(column);
            *value = match text {
                "" => None,
                text => Some(number(line, axis.name(), text)?),
            };
        }
        named.push(recording.to_owned());
        times.push(time);
        pictures.push(MeasuredPicture {
            picture,
            line,
            recording: 0,
            wrench,
        });
    }
    if pictures.is_empty() {
        return Err(ForcesError::Empty);
    }
    let by_name = columns.recording.is_none();
    Ok(in_order(pictures, by_name, &named, &times))
}

/// The rows recording by recording, in the order of time.
fn in_order(
    mut pictures: Vec<MeasuredPicture>,
    by_name: bool,
    named: &[String],
    times: &[Option<f64>],
) -> MeasuredForces {
    let (numbered_names, by_names) = recordings(pictures.iter().map(|p| p.picture.as_str()));
    let numbers = by_names.iter().map(|&(_, number)| number);
    let (recordings, of) = match by_name {
        true => (numbered_names, by_names.iter().map(|&(of, _)| of).collect()),
        false => number_names(named.iter().map(String::as_str)),
    };
    for (picture, &of) in pictures.iter_mut().zip(&of) {
        picture.recording = of;
    }
    let timed = times.iter().all(Option::is_some);
    let keys: Vec<_> = times.iter().zip(numbers).collect();
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

fn number(line: u64, field: &'static str, text: &str) -> Result<f64, ForcesError> {
    /// Far beyond any force or time, and far below where sums of squares overflow.
    const LARGEST: f64 = 1e12;
    let number = text.parse::<f64>().ok();
    let number = number.filter(|number| number.abs() <= LARGEST);
    number.ok_or_else(|| {
        wrong(
            line,
            field,
            text,
            "a finite number, or nothing where it was not measured",
        )
    })
}

fn wrong(line: u64, field: &'static str, value: &str, expected: &'static str) -> ForcesError {
    ForcesError::Field {
        line,
        field,
        value: value.to_owned(),
        expected,
    }
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
        assert_eq!(forces.pictures[0].wrench, [None; 6]);
        let [x, y, z, ..] = forces.pictures[1].wrench;
        assert_eq!(
            (x, y, z, forces.pictures[1].line),
            (Some(0.5), None, Some(-1.0), 2)
        );
        let text = "recording,time,m_z\nx.mcap,2.5,1\nx.mcap,1.5,2\n";
        let forces = read_forces(text.as_bytes()).unwrap();
        assert_eq!(forces.pictures[0].picture, "x.mcap@1.5");
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, words) in [
            ("f_x\n1\n", "no column picture"),
            ("recording,f_x\na,1\n", "no column time"),
            ("picture,force\na,1\n", "no column f_x"),
            ("picture,f_x,f_x\na,1,2\n", "\"f_x\" is twice"),
            ("picture,f_x\n", "no forces"),
            (
                "picture,f_x\na,inf\n",
                "line 2: f_x = \"inf\"; expected a finite",
            ),
            ("picture,f_x\na,1 N\n", "f_x = \"1 N\""),
            ("picture,f_x\n,1\n", "picture = \"\""),
            ("recording,time,f_x\na.mcap,,1\n", "time = \"\""),
            ("picture,f_x\na\n", "line: 2"),
        ] {
            let message = read_forces(text.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }

    proptest! {
        /// Whatever arrives is read or refused, and what is read is in order.
        #[test]
        fn hostile_text_is_read_or_refused(text in "(picture|recording|f_x|time|[a-z0-9,\n\"#.@/ -]){0,40}") {
            if let Ok(forces) = read_forces(text.as_bytes()) {
                prop_assert!(forces.pictures.windows(2).all(|p| p[0].recording <= p[1].recording));
                prop_assert!(forces.pictures.iter().all(|p| p.recording < forces.recordings.len()));
            }
        }
    }
}
