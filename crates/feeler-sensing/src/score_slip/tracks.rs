//! Reads recordings in the format of `feeler sense`: one row per element and frame.

use super::notes::Notes;
use super::options::RecordedOptions;
use super::sources::{Read, Source};
use feeler::sensor::fingertip::{LocatedLayout, MAX_LOCATED_ELEMENTS};
use feeler::sensor::table::{NumberColumn, Quantity, Table, TableError};
use feeler_console::{CommandError, open_table};
use feeler_lab::grasps::{ContactReference, GraspFrame, GraspRecording, Picture};
use glam::DVec2;
use std::fs;
use std::io::BufRead;
use std::path::{Path, PathBuf};

/// Pairs of columns that may contain the vectors, in order of preference.
const VECTORS: [[&str; 2]; 2] = [["u_x", "u_y"], ["f_x", "f_y"]];

/// Reader of tables of tracks.
pub struct TrackTables {
    /// Layout of all recordings that have no layout next to them.
    layout: Option<PathBuf>,
    rate: Option<f64>,
    untouched: bool,
}

impl TrackTables {
    /// Creates a reader with the options in `options`.
    pub fn new(options: &RecordedOptions) -> Self {
        Self {
            layout: options.layout.clone(),
            rate: options.rate,
            untouched: options.untouched,
        }
    }

    /// Reads the recordings in the table of `source`.
    ///
    /// # Errors
    /// If the table cannot be read.
    pub fn read(&self, source: &Source, notes: &mut Notes) -> Result<Vec<Read>, CommandError> {
        let [table] = source.tables.as_slice() else {
            let message = format!(
                "{}: expected one table per recording without --taxels, got several",
                source.name
            );
            return Err(message.into());
        };
        let (frames, on_places) = self.read_frames(table, notes)?;
        let layout = self.layout_of(source, table)?;
        let (mut untouched, mut origins) = (ContactReference::Unknown, Vec::new());
        match layout {
            _ if self.untouched => untouched = ContactReference::Zero,
            Some(layout) if layout.dome.is_none() && on_places => {
                let picture = Picture::of_size(layout.width, layout.height);
                untouched = ContactReference::Pattern(Some(picture));
                origins = layout.elements.iter().map(|element| element.centre_px).collect();
            }
            Some(_) => notes.add("dome", || format!("{}: positions on a dome and forces form no pattern in an image; contact is unknown", source.name)),
            None => notes.add("no layout", || format!("{}: no layout next to it, no --layout and no --untouched; contact is unknown", source.name)),
        }
        if let Some(most) = frames.iter().map(|frame| frame.shear.len()).max()
            && !origins.is_empty()
            && most > origins.len()
        {
            let (name, count) = (&source.name, origins.len());
            notes.add("elements", || format!("{name}: {most} elements, but only {count} in its layout; contact of the others is unknown"));
        }
        Ok(vec![Read {
            names: vec![source.stem().to_owned(), source.name.clone()],
            recording: GraspRecording {
                untouched,
                origins,
                frames,
            },
            images: Vec::new(),
        }])
    }

    /// Returns the layout next to the table, or the common layout.
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
                "{}: {e}; expected a layout from `feeler locate`",
                path.display()
            )
        };
        let text = fs::read_to_string(&path).map_err(|e| refused(&e))?;
        Ok(Some(
            LocatedLayout::from_toml(&text).map_err(|e| refused(&e))?,
        ))
    }

    /// Reads the frames. Also returns `true` if their vectors are displacements, `false` if forces.
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
                    notes.add("row", || refused(&format_args!("{error}; row skipped")));
                    if !error.affects_one_row() {
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
            return Err(refused(&"no readable row with a frame and an element").into());
        }
        let frames = frames.0.into_iter().map(|(_, frame)| frame);
        Ok((frames.collect(), columns.are_places))
    }
}

/// Returns `true` if the table at `path` contains tracks: it has the columns `frame` and `element`.
pub fn is_tracks(path: &Path) -> bool {
    let table = open_table(path)
        .ok()
        .and_then(|stream| Table::open(stream).ok());
    table.is_some_and(|table| {
        let there = |name| matches!(table.column(name), Ok(Some(_)));
        there("frame") && there("element")
    })
}

/// Indices of the columns in the table.
struct Columns {
    frame: usize,
    element: usize,
    /// Displacement or tangential force.
    vector: [NumberColumn; 2],
    /// `true` if the vectors are displacements in an image (px).
    are_places: bool,
    normal: Option<NumberColumn>,
    clock: Clock,
}

/// Source of the frames' times.
enum Clock {
    Rate(f64),
    Stamp(NumberColumn),
}

impl Columns {
    /// Finds the columns in a table. If `rate` is given, no time column is required.
    ///
    /// # Errors
    /// If a column is missing.
    fn find<R: BufRead>(table: &mut Table<R>, rate: Option<f64>) -> Result<Self, String> {
        let words = |e: TableError| e.to_string();
        let frame = table.column("frame").map_err(words)?;
        let element = table.column("element").map_err(words)?;
        let Some((frame, element)) = frame.zip(element) else {
            let (header, separator) = (table.header().shown(), table.separator());
            return Err(format!(
                "expected columns frame and element, got header {header:?}, read with {separator} between cells; use a table \
                 of `feeler sense`, or add --taxels"
            ));
        };
        let mut number = |name, quantity| table.number_column(name, quantity).map_err(words);
        let mut vector = None;
        for (kind, [x, y]) in VECTORS.into_iter().enumerate() {
            let both = number(x, Quantity::Any)?.zip(number(y, Quantity::Any)?);
            vector = vector.or(both.map(|(x, y)| (kind == 0, [x, y])));
        }
        let (are_places, vector) = vector.ok_or("expected columns u_x and u_y, or f_x and f_y")?;
        let normal = if are_places {
            None
        } else {
            number("f_z", Quantity::Any)?
        };
        let clock = match rate {
            Some(rate) => Clock::Rate(rate),
            None => Clock::Stamp(
                number("stamp", Quantity::Time)?.ok_or("expected a column stamp, or --rate")?,
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
    /// Adds the current row of a table. Calls `odd` with the kind and description of each irregularity.
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
            return odd("cells", "no frame and element; row skipped");
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
                "a cell is not a number; the element is ignored in this frame",
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
                "the element occurs twice in its frame; the last row is used",
            );
        }
        frame.shear[element] = vector.map_or(DVec2::NAN, |(x, y)| DVec2::new(x, y));
        if let Some(normal) = columns.normal {
            frame.normal.resize(frame.shear.len(), f64::NAN);
            frame.normal[element] = finite(normal).unwrap_or(f64::NAN);
        }
    }

    /// Starts the frame with this number.
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
            odd("stamp", "no time; the time of the previous frame is used");
        }
        let before = self.0.last();
        let stamp = known.unwrap_or(before.map_or(0.0, |(_, frame)| frame.stamp));
        if before.is_some_and(|(newest, frame)| number < *newest || stamp <= frame.stamp) {
            odd(
                "back",
                "the frame number decreases or the time does not increase; kept",
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
