//! Recordings as `feeler sense` writes them: a row for each element and frame.

use super::CommandError;
use super::collected::Read;
use super::notes::Notes;
use super::recorded::RecordedArguments;
use super::sources::Source;
use crate::table_file::open;
use feeler::sensor::located_layout::{LocatedLayout, MAX_LOCATED_ELEMENTS};
use feeler_lab::grasps::{GraspFrame, GraspRecording, Picture, Untouched};
use glam::DVec2;
use std::fs;
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
    /// As the arguments say.
    pub fn new(arguments: &RecordedArguments) -> Self {
        Self {
            layout: arguments.layout.clone(),
            rate: arguments.rate,
            untouched: arguments.untouched,
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
        table: &Path,
        notes: &mut Notes,
    ) -> Result<(Vec<GraspFrame>, bool), CommandError> {
        let refused = |what: &dyn std::fmt::Display| format!("{}: {what}", table.display());
        let stream = open(table).map_err(|e| refused(&e))?;
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(stream);
        let header = reader.headers().map_err(|e| refused(&e))?.clone();
        let find = |name: &str| header.iter().position(|column| column == name);
        let (Some(frame), Some(element)) = (find("frame"), find("element")) else {
            let what = "no columns frame and element in its header; expected a table of `feeler sense`, or --taxels";
            return Err(refused(&what).into());
        };
        let vector = VECTORS
            .iter()
            .position(|[x, y]| find(x).is_some() && find(y).is_some());
        let Some((kind, x, y)) = vector.and_then(|kind| {
            let [x, y] = VECTORS[kind];
            Some((kind, find(x)?, find(y)?))
        }) else {
            return Err(refused(&"no columns u_x and u_y, nor f_x and f_y").into());
        };
        let normal = find("f_z").filter(|_| VECTORS[kind] == ["f_x", "f_y"]);
        let stamp = find("stamp").filter(|_| self.rate.is_none());
        if stamp.is_none() && self.rate.is_none() {
            return Err(refused(&"no column stamp; expected one, or --rate").into());
        }
        let mut frames: Vec<(u64, GraspFrame)> = Vec::new();
        let mut cells = csv::StringRecord::new();
        loop {
            match reader.read_record(&mut cells) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => {
                    notes.add("row", || {
                        refused(&format_args!("{error}; the row is left out"))
                    });
                    if error.is_io_error() {
                        break;
                    }
                    continue;
                }
            }
            let line = cells.position().map_or(0, csv::Position::line);
            let odd = |what: &str| refused(&format_args!("line {line}: {what}"));
            let cell = |column: usize| cells.get(column).unwrap_or("");
            let element = cell(element)
                .parse()
                .ok()
                .filter(|&e: &usize| e < MAX_LOCATED_ELEMENTS);
            let (Ok(number), Some(element)) = (cell(frame).parse::<u64>(), element) else {
                notes.add("cells", || odd("no frame and element, left out"));
                continue;
            };
            let known = stamp.map_or(self.rate.map(|rate| number as f64 / rate), |stamp| {
                cell(stamp).parse().ok()
            });
            let known = known.filter(|stamp: &f64| stamp.is_finite());
            if frames.last().is_none_or(|(newest, _)| *newest != number) {
                if known.is_none() {
                    notes.add("stamp", || {
                        odd("no time; its frame is taken at that of the one before")
                    });
                }
                let before = frames.last().map_or(0.0, |(_, frame)| frame.stamp);
                let stamp = known.unwrap_or(before);
                if frames
                    .last()
                    .is_some_and(|(newest, frame)| number < *newest || stamp <= frame.stamp)
                {
                    notes.add("back", || {
                        odd("the frame or its time goes back or stands still; kept")
                    });
                }
                frames.push((
                    number,
                    GraspFrame {
                        stamp,
                        shear: Vec::new(),
                        normal: Vec::new(),
                    },
                ));
            }
            let number = |column: usize| {
                let value = cell(column).parse::<f64>();
                value.ok().filter(|value| value.is_finite())
            };
            let vector = number(x).zip(number(y));
            if vector.is_none() && !(cell(x).is_empty() && cell(y).is_empty()) {
                notes.add("number", || {
                    odd("a cell that is no number; nothing is known of its element in this frame")
                });
            }
            if let Some((_, frame)) = frames.last_mut() {
                if frame.shear.len() <= element {
                    frame.shear.resize(element + 1, DVec2::NAN);
                }
                if !frame.shear[element].is_nan() {
                    notes.add("element twice", || {
                        odd("the element stands twice in its frame; the last counts")
                    });
                }
                frame.shear[element] = vector.map_or(DVec2::NAN, |(x, y)| DVec2::new(x, y));
                if let Some(normal) = normal {
                    frame.normal.resize(frame.shear.len(), f64::NAN);
                    frame.normal[element] = number(normal).unwrap_or(f64::NAN);
                }
            }
        }
        Ok((
            frames.into_iter().map(|(_, frame)| frame).collect(),
            kind == 0,
        ))
    }
}
