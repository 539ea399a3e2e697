//! Destinations for the forces of taxels: a table, JSON Lines, or MCAP.

use super::super::output::{ForceRow, Format, FrameReadings, RowFile};
use super::super::wrench::{self, Estimates};
use feeler::sensor::forces::TactileFrame;
use feeler::sensor::taxel::{TaxelLayout, TaxelUnit};
use feeler::sensor::wrench::taxels::TaxelWrenchEstimator;
use feeler_console::CommandError;
use feeler_record::sensed::WRENCH;
use feeler_record::{MessageSink, SensedWriter, TaxelFacts, TaxelMessages};
use serde::Serialize;
use std::path::Path;

/// Output format of a taxel array.
pub struct TaxelFormat {
    facts: TaxelFacts,
    messages: TaxelMessages,
    /// Buffer for the forces of a frame.
    frame: TactileFrame,
    unit: TaxelUnit,
    names_sequences: bool,
    /// Estimates the total wrench, which replaces the forces of taxels in tables.
    estimates: Option<Estimates<TaxelWrenchEstimator>>,
}

impl TaxelFormat {
    /// Creates the format for `layout`. It writes wrenches if an `estimator` is given.
    pub fn of(
        layout: &TaxelLayout,
        estimator: Option<TaxelWrenchEstimator>,
    ) -> Result<Self, CommandError> {
        let unit = layout.force_unit();
        let facts = TaxelFacts {
            name: layout.name.clone(),
            unit: unit.name(),
            layout: layout.to_toml()?,
            elements: layout.elements().collect(),
            wrenches: estimator.is_some(),
        };
        Ok(Self {
            messages: TaxelMessages::new(&facts),
            frame: TactileFrame::unloaded(facts.elements.len()),
            facts,
            unit,
            names_sequences: layout.columns.sequence.is_some(),
            estimates: estimator.map(Estimates::new),
        })
    }
}

/// Columns of a row other than the force.
#[derive(Serialize)]
struct Row {
    frame: u64,
    stamp: f64,
    element: usize,
}

#[derive(Serialize)]
struct JsonRow<'a> {
    #[serde(flatten)]
    row: &'a Row,
    #[serde(flatten)]
    force: JsonForce<'a>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum JsonForce<'a> {
    Newton(&'a ForceRow),
    Counts {
        f_x_counts: Option<f64>,
        f_y_counts: Option<f64>,
        f_z_counts: Option<f64>,
    },
}

impl<'a> JsonForce<'a> {
    fn of(force: &'a ForceRow, unit: TaxelUnit) -> Self {
        match unit {
            TaxelUnit::Newton => Self::Newton(force),
            TaxelUnit::Counts => Self::Counts {
                f_x_counts: force.f_x,
                f_y_counts: force.f_y,
                f_z_counts: force.f_z,
            },
        }
    }
}

impl Format for TaxelFormat {
    fn columns(&self) -> Vec<&'static str> {
        if self.estimates.is_some() {
            return wrench::columns();
        }
        let forces = match self.unit {
            TaxelUnit::Newton => ["f_x", "f_y", "f_z"],
            TaxelUnit::Counts => ["f_x_counts", "f_y_counts", "f_z_counts"],
        };
        [["frame", "stamp", "element"], forces].concat()
    }

    fn names_sequences(&self) -> bool {
        self.names_sequences
    }

    /// Writes one row per taxel, or a single row with the wrench.
    fn write_rows(
        &mut self,
        frame: &FrameReadings,
        file: &mut RowFile,
    ) -> Result<(), CommandError> {
        if let Some(estimates) = &mut self.estimates {
            return wrench::write_row(frame, &estimates.next(frame), file);
        }
        for (element, reading) in frame.readings.iter().enumerate() {
            let force = &ForceRow::of(reading);
            let row = &Row {
                frame: frame.sequence,
                stamp: frame.stamp,
                element,
            };
            let object = JsonRow {
                row,
                force: JsonForce::of(force, self.unit),
            };
            file.write_either(&(row, force), &object)?;
        }
        Ok(())
    }

    fn create_mcap(&self, path: &Path) -> Result<SensedWriter, CommandError> {
        Ok(SensedWriter::create_for_taxels(path, &self.facts)?)
    }

    fn write_messages(
        &mut self,
        frame: &FrameReadings,
        writer: &mut SensedWriter,
    ) -> Result<(), CommandError> {
        (self.frame.sequence, self.frame.stamp) = (frame.sequence, frame.stamp);
        self.frame.forces.clear();
        self.frame.forces.extend(frame.forces());
        self.messages.write(&self.frame, writer)?;
        if let Some(estimates) = &mut self.estimates {
            let estimate = estimates.next(frame);
            writer.write(WRENCH, &wrench::message(frame.stamp, &estimate))?;
        }
        Ok(())
    }

    fn begin_sequence(&mut self) {
        if let Some(estimates) = &mut self.estimates {
            estimates.restart();
        }
    }

    fn warning(&self) -> Option<String> {
        self.estimates.as_ref().and_then(Estimates::warning)
    }
}
