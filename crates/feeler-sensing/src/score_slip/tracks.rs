//! Recordings as `feeler sense` writes them: a row for each element and frame.

use super::collected::Read;
use super::notes::Notes;
use super::recorded::RecordedOptions;
use super::sources::Source;
use feeler::sensor::located_layout::{LocatedLayout, MAX_LOCATED_ELEMENTS};
use feeler::sensor::table::{NumberColumn, Quantity, Table, TableError};
use feeler_console::CommandError;
use feeler_console::open_table;
use feeler_lab::grasps::{GraspFrame, GraspRecording, Picture, Untouched};
use glam::DVec2;
use std::fs;
use std::io::BufRead;
use std::path::{Path, PathBuf};

/// Pairs of columns that hold what moves, in the order in which they are looked for.
const VECTORS: [[&str; 2]; 2] = [["u_x", "u_y"], ["f_x", "f_y"]];

/// Reads tables of tracks.
pub struct TrackTables {
    /// The layout of all recordings that have none beside them.
    layout: Option<PathBuf>,
    rate: Option<f64>,
    untouched: bool,
}

impl TrackTables {
    /// As the options say.
    pub fn new(options: &RecordedOptions) -> Self {
        Self {
            layout: options.layout.clone(),
            rate: options.rate,
            untouched: options.untouched,
        }
    }

    /// The recording in the table of `source`.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn read(&self, source: &Source, notes: &mut Notes) -> Result<Vec<Read>, CommandError> {
        let [table] = source.tables.as_slice() else {
            let message = format!(
                "{}: several tables; expected one for a recording without --taxels",
                source.name
            );
            return Err(message.into());
        };
        let (frames, on_places) = self.read_frames(table, notes)?;
        let layout = self.layout_of(source, table)?;
        let (mut untouched, mut origins) = (Untouched::Unknown, Vec::new());
        match layout {
            _ if self.untouched => untouched = Untouched::Zero,
            Some(layout) if layout.dome.is_none() && on_places => {
                let picture = Picture::of_size(layout.width, layout.height);
                untouched = Untouched::Pattern(Some(picture));
                origins = layout.elements.iter().map(|element| element.centre_px).collect();
            }
            Some(_) => notes.add("dome", || format!("{}: places on a dome, or forces, are no pattern in a picture: nothing is known of contact", source.name)),
            None => notes.add("no layout", || format!("{}: no layout beside it, no --layout, no --untouched: nothing is known of contact", source.name)),
        }
        if let Some(most) = frames.iter().map(|frame| frame.shear.len()).max()
            && !origins.is_empty()
            && most > origins.len()
        {
            let (name, count) = (&source.name, origins.len());
            notes.add("elements", || format!("{name}: {most} elements, {count} in its layout; nothing is known of the contact of the others"));
        }
        Ok(vec![Read {
            names: vec![source.stem().to_owned(), source.name.clone()],
            recording: GraspRecording {
                untouched,
                origins,
                frames,
            },
        }])
    }

    /// The layout beside the table, or that of all.
    fn layout_of(
        &self,
        source: &Source,
        table: &Path,
    ) -> Result<Option<LocatedLayout>, CommandError> {
        let beside = table.with_file_name(format!("{}.toml", source.stem()));
        let path = match &self.layout {
            _ if beside.is_file() => beside,
            Some(layout) => layout.clone(),
            None => return Ok(None),
        };
        let refused = |e: &dyn std::fmt::Display| {
            format!(
                "{}: {e}; expected a layout of `feeler locate`",
                path.display()
            )
        };
        let text = fs::read_to_string(&path).map_err(|e| refused(&e))?;
        Ok(Some(
            LocatedLayout::from_toml(&text).map_err(|e| refused(&e))?,
        ))
    }

    /// The frames, and whether they hold displacements, not forces.
    fn read_frames(
        &self,
        path: &Path,
        notes: &mut Notes,
    ) -> Result<(Vec<GraspFrame>, bool), CommandError> {
        let refused = |what: &dyn std::fmt::Display| format!("{}: {what}", path.display());
        let stream = open_table(path).map_err(|e| refused(&e))?;
        let mut table = Table::open(stream).map_err(|e| refused(&e))?;
        let columns = Columns::find(&mut table, self.rate);
        let columns = columns.map_err(|what| refused(&what))?;
        let mut frames = Frames::default();
        loop {
            match table.advance() {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => {
                    notes.add("row", || {
                        refused(&format_args!("{error}; the row is left out"))
                    });
                    if !error.is_of_a_row() {
                        break;
                    }
                    continue;
                }
            }
            let mut odd = |kind: &str, what: &str| {
                notes.add(kind, || {
                    refused(&format_args!("line {}: {what}", table.line()))
                });
            };
            frames.take(&table, &columns, &mut odd);
        }
        if frames.0.is_empty() {
            return Err(refused(&"no row with a frame and an element can be read").into());
        }
        let frames = frames.0.into_iter().map(|(_, frame)| frame);
        Ok((frames.collect(), columns.are_places))
    }
}

/// Whether the table at `path` is one of tracks: it has a frame and an element in each row.
pub fn is_tracks(path: &Path) -> bool {
    let table = open_table(path)
        .ok()
        .and_then(|stream| Table::open(stream).ok());
    table.is_some_and(|table| {
        let there = |name| matches!(table.column(name), Ok(Some(_)));
        there("frame") && there("element")
    })
}

/// Where the columns are.
struct Columns {
    frame: usize,
    element: usize,
    /// What moves, or pulls.
    vector: [NumberColumn; 2],
    /// Whether that is in a picture.
    are_places: bool,
    normal: Option<NumberColumn>,
    clock: Clock,
}

/// Where the times of frames are from.
enum Clock {
    Rate(f64),
    Stamp(NumberColumn),
}

impl Columns {
    /// In a table, whose frames come at a `rate` if it is given.
    ///
    /// # Errors
    /// If one is missing.
    fn find<R: BufRead>(table: &mut Table<R>, rate: Option<f64>) -> Result<Self, String> {
        let words = |e: TableError| e.to_string();
        let frame = table.column("frame").map_err(words)?;
        let element = table.column("element").map_err(words)?;
        let Some((frame, element)) = frame.zip(element) else {
            let (header, separator) = (table.header().shown(), table.separator());
            return Err(format!(
                "no columns frame and element in its header {header:?}, read with {separator} between cells; expected a table of \
                 `feeler sense`, or --taxels"
            ));
        };
        let mut number = |name, quantity| table.number_column(name, quantity).map_err(words);
        let mut vector = None;
        for (kind, [x, y]) in VECTORS.into_iter().enumerate() {
            let both = number(x, Quantity::Any)?.zip(number(y, Quantity::Any)?);
            vector = vector.or(both.map(|(x, y)| (kind == 0, [x, y])));
        }
        let (are_places, vector) = vector.ok_or("no columns u_x and u_y, nor f_x and f_y")?;
        let normal = if are_places {
            None
        } else {
            number("f_z", Quantity::Any)?
        };
        let clock = match rate {
            Some(rate) => Clock::Rate(rate),
            None => Clock::Stamp(
                number("stamp", Quantity::Time)?
                    .ok_or("no column stamp; expected one, or --rate")?,
            ),
        };
        Ok(Self {
            frame,
            element,
            vector,
            are_places,
            normal,
            clock,
        })
    }
}

/// Frames by number.
#[derive(Default)]
struct Frames(Vec<(u64, GraspFrame)>);

impl Frames {
    /// Takes the newest row of a table; calls `odd` with the kind and the words of what is.
    fn take<R: BufRead>(
        &mut self,
        table: &Table<R>,
        columns: &Columns,
        odd: &mut impl FnMut(&str, &str),
    ) {
        let element = table.whole(columns.element);
        let element = element
            .and_then(|e| usize::try_from(e).ok())
            .filter(|&e| e < MAX_LOCATED_ELEMENTS);
        let (Some(number), Some(element)) = (table.whole(columns.frame), element) else {
            return odd("cells", "no frame and element, left out");
        };
        if self.0.last().is_none_or(|(newest, _)| *newest != number) {
            self.begin(number, table, &columns.clock, odd);
        }
        let finite = |column| table.number(column).ok().filter(|value| value.is_finite());
        let [x, y] = columns.vector.map(finite);
        let vector = x.zip(y);
        if vector.is_none()
            && columns
                .vector
                .iter()
                .any(|&column| !table.number_text(column).is_empty())
        {
            odd(
                "number",
                "a cell that is no number; nothing is known of its element in this frame",
            );
        }
        let Some((_, frame)) = self.0.last_mut() else {
            return;
        };
        if frame.shear.len() <= element {
            frame.shear.resize(element + 1, DVec2::NAN);
        }
        if !frame.shear[element].is_nan() {
            odd(
                "element twice",
                "the element stands twice in its frame; the last counts",
            );
        }
        frame.shear[element] = vector.map_or(DVec2::NAN, |(x, y)| DVec2::new(x, y));
        if let Some(normal) = columns.normal {
            frame.normal.resize(frame.shear.len(), f64::NAN);
            frame.normal[element] = finite(normal).unwrap_or(f64::NAN);
        }
    }

    /// Begins the frame of this number.
    fn begin<R: BufRead>(
        &mut self,
        number: u64,
        table: &Table<R>,
        clock: &Clock,
        odd: &mut impl FnMut(&str, &str),
    ) {
        let known = match *clock {
            Clock::Rate(rate) => Some(number as f64 / rate),
            Clock::Stamp(stamp) => table.number(stamp).ok(),
        };
        let known = known.filter(|stamp| stamp.is_finite());
        if known.is_none() {
            odd(
                "stamp",
                "no time; its frame is taken at that of the one before",
            );
        }
        let before = self.0.last();
        let stamp = known.unwrap_or(before.map_or(0.0, |(_, frame)| frame.stamp));
        if before.is_some_and(|(newest, frame)| number < *newest || stamp <= frame.stamp) {
            odd(
                "back",
                "the frame or its time goes back or stands still; kept",
            );
        }
        let (shear, normal) = (Vec::new(), Vec::new());
        self.0.push((
            number,
            GraspFrame {
                stamp,
                shear,
                normal,
            },
        ));
    }
}
