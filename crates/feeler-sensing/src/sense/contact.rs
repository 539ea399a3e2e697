//! Writes the contact of each frame as a table, JSON Lines, or MCAP.

use super::output::{Format, FrameReadings, Output, RowFile, RowWriter};
use feeler::sensor::contact::{Contact, ContactEstimator};
use feeler::sensor::fingertip::SensingElement;
use feeler::sensor::forces::NO_FORCE;
use feeler::sensor::taxel::{TaxelLayout, TaxelUnit};
use feeler_console::CommandError;
use feeler_record::sensed::{CONTACT, TACTILE};
use feeler_record::{Contact as Message, MessageSink, SensedWriter, Tactile};
use glam::DVec3;
use serde::{Serialize, Serializer};
use std::path::{Path, PathBuf};

/// Compression above which an element of a fingertip touches by default, N: F1 of the paper.
const TOUCH: f64 = 0.1;

/// Settings of `--contact`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactOptions {
    /// Minimum compression of a touching element, N, or counts if the forces are in counts; `None` for the default.
    pub touch: Option<f64>,
    /// Coefficient of friction, or `None` to estimate it.
    pub friction: Option<f64>,
}

/// Name of a column and its value.
type Column = (&'static str, fn(&Contact) -> Option<f64>);

/// Columns that describe a contact.
const COLUMNS: [Column; 24] = [
    ("c_x", |c| Some(c.centre.x)),
    ("c_y", |c| Some(c.centre.y)),
    ("c_z", |c| Some(c.centre.z)),
    ("c_error", |c| Some(c.centre_error)),
    ("n_x", |c| Some(c.normal.x)),
    ("n_y", |c| Some(c.normal.y)),
    ("n_z", |c| Some(c.normal.z)),
    ("f_x", |c| Some(c.force.x)),
    ("f_y", |c| Some(c.force.y)),
    ("f_z", |c| Some(c.force.z)),
    ("f_error", |c| Some(c.force_error)),
    ("torsion", |c| Some(c.torsion)),
    ("torsion_error", |c| Some(c.torsion_error)),
    ("area", |c| Some(c.ellipse?.area())),
    ("area_error", |c| Some(c.ellipse?.area_error())),
    ("long_axis", |c| Some(c.ellipse?.semi_axes[0])),
    ("long_axis_error", |c| Some(c.ellipse?.errors[0])),
    ("short_axis", |c| Some(c.ellipse?.semi_axes[1])),
    ("short_axis_error", |c| Some(c.ellipse?.errors[1])),
    ("long_x", |c| Some(c.ellipse?.direction.x)),
    ("long_y", |c| Some(c.ellipse?.direction.y)),
    ("long_z", |c| Some(c.ellipse?.direction.z)),
    ("friction", |c| c.friction),
    ("sliding", |c| c.sliding),
];

/// Output format for the contact in each frame.
pub struct ContactFormat {
    estimator: ContactEstimator,
    /// Unit of the forces.
    unit: TaxelUnit,
    /// `true` if a column names sequences.
    sequences: bool,
}

impl ContactFormat {
    /// Creates the format for a fingertip with `elements` at these positions (m, in `T`).
    pub fn new(
        options: ContactOptions,
        elements: impl IntoIterator<Item = (SensingElement, DVec3)>,
    ) -> Self {
        let estimator = ContactEstimator::new(elements, options.touch.unwrap_or(TOUCH));
        Self {
            estimator: match options.friction {
                Some(friction) => estimator.with_friction(friction),
                None => estimator,
            },
            unit: TaxelUnit::Newton,
            sequences: false,
        }
    }

    /// Creates the format for a taxel array.
    ///
    /// # Errors
    /// If the forces are in counts and `options` have no threshold.
    pub fn of_taxels(options: ContactOptions, layout: &TaxelLayout) -> Result<Self, CommandError> {
        let unit = layout.force_unit();
        if options.touch.is_none() && unit == TaxelUnit::Counts {
            return Err(
                "--contact: requires --contact=COUNTS, because the forces are in counts".into(),
            );
        }
        Ok(Self {
            unit,
            sequences: layout.columns.sequence.is_some(),
            ..Self::new(options, layout.elements())
        })
    }

    /// Names of all columns.
    fn columns(&self) -> Vec<&'static str> {
        let first = self.sequences.then_some("sequence").into_iter();
        let first = first.chain(["frame", "stamp", "invalid", "touching"]);
        let named = |name| match (self.unit, name) {
            (TaxelUnit::Counts, "f_x") => "f_x_counts",
            (TaxelUnit::Counts, "f_y") => "f_y_counts",
            (TaxelUnit::Counts, "f_z") => "f_z_counts",
            (TaxelUnit::Counts, "f_error") => "f_error_counts",
            (TaxelUnit::Counts, "torsion") => "torsion_counts_m",
            (TaxelUnit::Counts, "torsion_error") => "torsion_error_counts_m",
            (_, name) => name,
        };
        first.chain(COLUMNS.map(|(name, _)| named(name))).collect()
    }

    fn rows(&self, file: RowFile) -> Box<dyn Output> {
        Box::new(Rows {
            file,
            columns: self.columns(),
            estimator: self.estimator.clone(),
            forces: Vec::new(),
            sequence: self.sequences.then(String::new),
        })
    }
}

impl Format for ContactFormat {
    fn csv(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        Ok(self.rows(RowFile::csv(writer, self.columns())?))
    }

    fn jsonl(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        Ok(self.rows(RowFile::json_lines(writer)))
    }

    fn mcap(&self, path: &Path) -> Result<Box<dyn Output>, CommandError> {
        if self.unit == TaxelUnit::Counts {
            return Err("messages of type Contact are in newtons, but the forces are in counts; write .csv or .jsonl".into());
        }
        Ok(Box::new(Mcap {
            writer: SensedWriter::create_for_contacts(path)?,
            estimator: self.estimator.clone(),
        }))
    }
}

/// Copies the forces of a frame.
fn copy_forces(frame: &FrameReadings, forces: &mut Vec<DVec3>) {
    forces.clear();
    forces.extend(frame.readings.iter().map(|r| r.force.unwrap_or(NO_FORCE)));
}

/// A cell of a row; missing values are empty.
#[derive(Serialize)]
#[serde(untagged)]
enum Cell<'a> {
    Text(&'a str),
    Count(u64),
    Number(Option<f64>),
}

impl Cell<'_> {
    /// Missing and unknown values are empty.
    fn number(number: Option<f64>) -> Self {
        Self::Number(number.filter(|number| number.is_finite()))
    }
}

/// A row with the names of its cells.
struct NamedCells<'a>(&'a [&'static str], &'a [Cell<'a>]);

impl Serialize for NamedCells<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().zip(self.1))
    }
}

/// Writer of one row per frame.
struct Rows {
    file: RowFile,
    /// Names of the columns.
    columns: Vec<&'static str>,
    estimator: ContactEstimator,
    forces: Vec<DVec3>,
    /// Name of the current sequence, if a column names sequences.
    sequence: Option<String>,
}

impl Output for Rows {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        copy_forces(frame, &mut self.forces);
        let contact = self.estimator.estimate(&self.forces);
        let invalid = self
            .forces
            .iter()
            .filter(|force| !force.is_finite())
            .count();
        let touching = contact.map_or(0, |contact| contact.touching);
        let sequence = self.sequence.as_deref().map(Cell::Text).into_iter();
        let cells: Vec<_> = sequence
            .chain([Cell::Count(frame.sequence), Cell::number(Some(frame.stamp))])
            .chain([invalid, touching].map(|count| Cell::Count(count as u64)))
            .chain(COLUMNS.map(|(_, value)| Cell::number(contact.as_ref().and_then(value))))
            .collect();
        let object = NamedCells(&self.columns, &cells);
        self.file.write_either(&cells, &object)
    }

    fn begin_sequence(&mut self, name: &str) -> Result<(), CommandError> {
        self.estimator.restart();
        if let Some(sequence) = &mut self.sequence {
            name.clone_into(sequence);
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(self.file.flush()?)
    }
}

/// ROS 2 messages in an MCAP file: forces and contacts.
struct Mcap {
    writer: SensedWriter,
    estimator: ContactEstimator,
}

impl Output for Mcap {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        let (sequence, stamp) = (frame.sequence, frame.stamp);
        let mut of_elements = Vec::with_capacity(frame.readings.len());
        copy_forces(frame, &mut of_elements);
        let contact = self.estimator.estimate(&of_elements);
        let forces = of_elements.into_iter().map(Into::into).collect();
        let tactile = Tactile {
            sequence,
            stamp,
            forces,
        };
        self.writer.write(TACTILE, &tactile)?;
        let message = Message::new(sequence, stamp, contact.as_ref());
        Ok(self.writer.write(CONTACT, &message)?)
    }

    fn begin_sequence(&mut self, _: &str) -> Result<(), CommandError> {
        self.estimator.restart();
        Ok(())
    }

    /// Does nothing, because each flush adds 0.6 KB to the file.
    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(())
    }

    fn settle(&mut self) -> Result<(), CommandError> {
        Ok(self.writer.flush()?)
    }

    fn finish(self: Box<Self>, _: bool) -> Result<Option<PathBuf>, CommandError> {
        Ok(self.writer.finish().map(|()| None)?)
    }
}
