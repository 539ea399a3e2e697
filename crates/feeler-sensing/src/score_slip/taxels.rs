//! Reads recordings of three-axis taxel arrays.

use super::notes::Notes;
use super::options::RecordedOptions;
use super::sources::{Read, Source};
use crate::sense::taxel_layout_text;
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler::sensor::taxel::{TaxelLayout, TaxelSensor};
use feeler_console::{CommandError, open_table};
use feeler_lab::grasps::{ContactReference, GraspFrame, GraspRecording};
use glam::DVec2;
use std::path::Path;

/// Reader of the tables of one or more taxel arrays that measured the same grasp.
pub struct TaxelTables {
    /// Layout of each array in a table; they differ only in the column prefix.
    layouts: Vec<TaxelLayout>,
    rate: Option<f64>,
    untouched: bool,
}

/// Frames of one array by the name of their sequence, which is empty if there are no sequences.
type Sequences = Vec<(String, Vec<GraspFrame>)>;

impl TaxelTables {
    /// Creates a reader for the layout `name` with the options in `options`.
    ///
    /// # Errors
    /// If the layout does not exist or is invalid.
    pub fn new(name: &str, options: &RecordedOptions) -> Result<Self, CommandError> {
        let refused = |e| format!("--taxels {name}: {e}");
        let layout = TaxelLayout::from_toml(&taxel_layout_text(name)?).map_err(refused)?;
        let prefixes = match options.prefixes.as_slice() {
            [] => vec![layout.columns.prefix.clone()],
            prefixes => prefixes.to_vec(),
        };
        let with_prefix = |prefix: String| {
            let mut layout = layout.clone();
            layout.columns.prefix = prefix;
            if options.sequence.is_some() {
                layout.columns.sequence.clone_from(&options.sequence);
            }
            layout.check().map_err(refused).map(|()| layout)
        };
        let layouts: Vec<_> = prefixes
            .into_iter()
            .map(with_prefix)
            .collect::<Result<_, _>>()?;
        // Zeros in a layout were measured without load; the first rows of a grasp may already be in contact.
        let given = |layout: &TaxelLayout| layout.taxels.iter().all(|taxel| taxel.zero.is_some());
        let untouched = options.untouched || layouts.iter().all(given);
        Ok(Self {
            layouts,
            rate: options.rate,
            untouched,
        })
    }

    /// Unit of the shear vectors.
    pub fn unit(&self) -> &'static str {
        self.layouts
            .first()
            .map_or("counts", |layout| layout.force_unit().name())
    }

    /// Reads the recordings in the tables of `source`.
    ///
    /// # Errors
    /// If a table cannot be read.
    pub fn read(&self, source: &Source, notes: &mut Notes) -> Result<Vec<Read>, CommandError> {
        let mut arrays: Vec<(usize, Sequences)> = Vec::new();
        for table in &source.tables {
            for layout in &self.layouts {
                arrays.push((layout.taxels.len(), self.read_array(table, layout, notes)?));
            }
        }
        let Some((_, first)) = arrays.first() else {
            return Ok(Vec::new());
        };
        let names: Vec<_> = first.iter().map(|(name, _)| name.clone()).collect();
        let together = |name: String| {
            let own = arrays.iter().map(|(taxels, sequences)| {
                let same = sequences.iter().find(|(other, _)| *other == name);
                (*taxels, same.map_or(&[][..], |(_, frames)| frames))
            });
            let own: Vec<_> = own.collect();
            let recording = if name.is_empty() {
                source.stem()
            } else {
                &name
            };
            Read {
                names: match name.is_empty() {
                    true => vec![source.stem().to_owned(), source.name.clone()],
                    false => vec![name.clone()],
                },
                recording: GraspRecording {
                    untouched: match self.untouched {
                        true => ContactReference::Zero,
                        false => ContactReference::Unknown,
                    },
                    origins: Vec::new(),
                    frames: side_by_side(&own, recording, notes),
                },
                images: Vec::new(),
            }
        };
        Ok(names.into_iter().map(together).collect())
    }

    fn read_array(
        &self,
        table: &Path,
        layout: &TaxelLayout,
        notes: &mut Notes,
    ) -> Result<Sequences, CommandError> {
        let refused = |error: &dyn std::fmt::Display| format!("{}: {error}", table.display());
        let stream = open_table(table).map_err(|e| refused(&e))?;
        let mut sensor = TaxelSensor::open(stream, layout, self.rate).map_err(|e| refused(&e))?;
        let mut frame = TactileFrame::unloaded(sensor.element_count());
        let mut sequences = Sequences::new();
        let mut own = 0;
        let ended = loop {
            match sensor.read(&mut frame) {
                Ok(()) => {}
                Err(SensorError::Ended { .. }) => break Ok(()),
                Err(error) => break Err(error),
            }
            if sensor.starts_sequence() || sequences.is_empty() {
                let name = String::from_utf8_lossy(sensor.sequence()).into_owned();
                let known = sequences.iter().position(|(other, _)| *other == name);
                if known.is_some() {
                    notes.add("again", || {
                        refused(&format_args!(
                            "sequence {name:?} continues after another one; its parts are joined"
                        ))
                    });
                }
                own = known.unwrap_or_else(|| {
                    sequences.push((name, Vec::new()));
                    sequences.len() - 1
                });
            }
            if let Some((_, frames)) = sequences.get_mut(own) {
                frames.push(GraspFrame {
                    stamp: frame.stamp,
                    shear: frame.forces.iter().map(|force| force.truncate()).collect(),
                    normal: frame.forces.iter().map(|force| force.z).collect(),
                });
            }
        };
        for problem in sensor.problems().iter() {
            let column = problem.first.column.and_then(|c| sensor.columns().get(c));
            let words = problem.in_words(column.map(String::as_str));
            notes.add(&format!("{:?}", problem.problem), || refused(&words));
        }
        if let Err(error) = ended {
            if sequences.is_empty() {
                return Err(refused(&error).into());
            }
            notes.add("torn", || {
                refused(&format_args!("{error}; the rows before it are used"))
            });
        }
        Ok(sequences)
    }
}

/// Joins the frames of several arrays. If an array has fewer frames, its missing elements are NaN.
fn side_by_side(
    arrays: &[(usize, &[GraspFrame])],
    name: &str,
    notes: &mut Notes,
) -> Vec<GraspFrame> {
    let lengths = arrays.iter().map(|(_, frames)| frames.len());
    let (least, most) = (
        lengths.clone().min().unwrap_or(0),
        lengths.max().unwrap_or(0),
    );
    if least < most {
        notes.add("length", || {
            format!("{name}: arrays have between {least} and {most} rows; missing rows are ignored")
        });
    }
    let frame = |number: usize| {
        let there = arrays.iter().find_map(|(_, frames)| frames.get(number));
        GraspFrame {
            stamp: there.map_or(f64::NAN, |frame| frame.stamp),
            shear: joined(arrays, number, |frame| &frame.shear, DVec2::NAN),
            normal: joined(arrays, number, |frame| &frame.normal, f64::NAN),
        }
    };
    (0..most).map(frame).collect()
}

/// Concatenates the values that `part` selects from frame `number` of each array. Absent taxels have the value
/// `missing`.
fn joined<T: Copy>(
    arrays: &[(usize, &[GraspFrame])],
    number: usize,
    part: impl Fn(&GraspFrame) -> &[T],
    missing: T,
) -> Vec<T> {
    let own = arrays.iter().flat_map(|(taxels, frames)| {
        let own = frames.get(number).map_or(&[][..], &part);
        let lacking = taxels - own.len().min(*taxels);
        own.iter()
            .copied()
            .chain(std::iter::repeat_n(missing, lacking))
    });
    own.collect()
}
