//! Writes the contact of each frame as a table, JSON Lines, or MCAP.

use super::output::{Format, FrameReadings, RowFile, tactile};
use feeler::sensor::contact::{Contact, ContactEstimator};
use feeler::sensor::fingertip::SensingElement;
use feeler::sensor::taxel::{TaxelLayout, TaxelUnit};
use feeler_console::CommandError;
use feeler_record::sensed::{CONTACT, TACTILE};
use feeler_record::{Contact as Message, MessageSink, SensedWriter};
use glam::DVec3;
use serde::{Serialize, Serializer};
use std::path::Path;

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

/// Name of a column, and a function that returns its value, or `None` if unknown.
type Column = (&'static str, fn(&Contact) -> Option<f64>);

/// Columns of a table that describe a contact, after those of the frame.
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
    /// Forces of the current frame.
    forces: Vec<DVec3>,
    /// Names of the columns.
    columns: Vec<&'static str>,
    /// Unit of the forces.
    unit: TaxelUnit,
    names_sequences: bool,
}

impl ContactFormat {
    /// Creates the format for a fingertip with `elements` at these positions (m, in `T`).
    pub fn new(
        options: ContactOptions,
        elements: impl IntoIterator<Item = (SensingElement, DVec3)>,
    ) -> Self {
        let mut estimator = ContactEstimator::new(elements, options.touch.unwrap_or(TOUCH));
        if let Some(friction) = options.friction {
            estimator = estimator.with_friction(friction);
        }
        Self {
            estimator,
            forces: Vec::new(),
            columns: columns(TaxelUnit::Newton),
            unit: TaxelUnit::Newton,
            names_sequences: false,
        }
    }

    /// Creates the format for a taxel array.
    ///
    /// # Errors
    /// If the forces are in counts and `options` contain no threshold.
    pub fn of_taxels(options: ContactOptions, layout: &TaxelLayout) -> Result<Self, CommandError> {
        let unit = layout.force_unit();
        if options.touch.is_none() && unit == TaxelUnit::Counts {
            return Err(
                "--contact: requires --contact=COUNTS, because the forces are in counts".into(),
            );
        }
        Ok(Self {
            columns: columns(unit),
            unit,
            names_sequences: layout.columns.sequence.is_some(),
            ..Self::new(options, layout.elements())
        })
    }

    /// Estimates the contact in the next frame.
    fn estimate(&mut self, frame: &FrameReadings) -> Option<Contact> {
        self.forces.clear();
        self.forces.extend(frame.forces());
        self.estimator.estimate(&self.forces)
    }
}

/// Names of all columns for forces in `unit`.
fn columns(unit: TaxelUnit) -> Vec<&'static str> {
    let named = |name| match (unit, name) {
        (TaxelUnit::Counts, "f_x") => "f_x_counts",
        (TaxelUnit::Counts, "f_y") => "f_y_counts",
        (TaxelUnit::Counts, "f_z") => "f_z_counts",
        (TaxelUnit::Counts, "f_error") => "f_error_counts",
        (TaxelUnit::Counts, "torsion") => "torsion_counts_m",
        (TaxelUnit::Counts, "torsion_error") => "torsion_error_counts_m",
        (_, name) => name,
    };
    let of_frame = ["frame", "stamp", "invalid", "touching"];
    let of_contact = COLUMNS.map(|(name, _)| named(name));
    of_frame.into_iter().chain(of_contact).collect()
}

/// A cell of a row.
#[derive(Serialize)]
#[serde(untagged)]
enum Cell {
    Count(u64),
    /// Empty if unknown.
    Number(Option<f64>),
}

/// A row: column names and cells.
struct NamedCells<'a>(&'a [&'static str], &'a [Cell]);

impl Serialize for NamedCells<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().zip(self.1))
    }
}

impl Format for ContactFormat {
    fn columns(&self) -> Vec<&'static str> {
        self.columns.clone()
    }

    fn names_sequences(&self) -> bool {
        self.names_sequences
    }

    fn write_rows(
        &mut self,
        frame: &FrameReadings,
        file: &mut RowFile,
    ) -> Result<(), CommandError> {
        let contact = self.estimate(frame);
        let invalid = self.forces.iter().filter(|f| !f.is_finite()).count();
        let touching = contact.map_or(0, |contact| contact.touching);
        let number = |number: Option<f64>| Cell::Number(number.filter(|n| n.is_finite()));
        let of_frame = [
            Cell::Count(frame.sequence),
            number(Some(frame.stamp)),
            Cell::Count(invalid as u64),
            Cell::Count(touching as u64),
        ];
        let of_contact = COLUMNS.map(|(_, value)| number(contact.as_ref().and_then(value)));
        let cells: Vec<_> = of_frame.into_iter().chain(of_contact).collect();
        file.write_either(&cells, &NamedCells(&self.columns, &cells))
    }

    fn create_mcap(&self, path: &Path) -> Result<SensedWriter, CommandError> {
        if self.unit == TaxelUnit::Counts {
            return Err("messages of type Contact are in newtons, but the forces are in counts; write .csv or .jsonl".into());
        }
        Ok(SensedWriter::create_for_contacts(path)?)
    }

    fn write_messages(
        &mut self,
        frame: &FrameReadings,
        writer: &mut SensedWriter,
    ) -> Result<(), CommandError> {
        let tactile = tactile(frame);
        writer.write(TACTILE, &tactile)?;
        let contact = self.estimate(frame);
        let message = Message::new(&tactile, contact.as_ref());
        Ok(writer.write(CONTACT, &message)?)
    }

    fn begin_sequence(&mut self) {
        self.estimator.restart();
    }
}
