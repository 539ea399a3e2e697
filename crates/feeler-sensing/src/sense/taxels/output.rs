//! Destinations for the forces of taxels: a table, JSON Lines, or MCAP.

use super::super::output::{ForceRow, Format, FrameReadings, Output, RowFile, RowWriter};
use super::super::wrench::{self, Estimates};
use feeler::sensor::forces::{NO_FORCE, TactileFrame};
use feeler::sensor::taxel::{TaxelLayout, TaxelUnit};
use feeler::sensor::wrench::taxels::TaxelWrenchEstimator;
use feeler_console::CommandError;
use feeler_record::{TaxelFacts, TaxelWriter};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Output formats of a taxel array.
pub struct TaxelFormat {
    facts: TaxelFacts,
    unit: TaxelUnit,
    /// `true` if a column names sequences.
    sequences: bool,
    /// Estimates the total wrench, which replaces the forces of taxels in tables.
    estimator: Option<TaxelWrenchEstimator>,
}

impl TaxelFormat {
    /// Creates the formats for `layout`; for wrenches if an `estimator` is given.
    pub fn of(
        layout: &TaxelLayout,
        estimator: Option<TaxelWrenchEstimator>,
    ) -> Result<Self, CommandError> {
        let unit = layout.force_unit();
        Ok(Self {
            facts: TaxelFacts {
                name: layout.name.clone(),
                unit: unit.name(),
                layout: layout.to_toml()?,
                elements: layout.elements().collect(),
                wrenches: estimator.is_some(),
            },
            unit,
            sequences: layout.columns.sequence.is_some(),
            estimator,
        })
    }

    fn rows(&self, file: RowFile) -> Box<dyn Output> {
        Box::new(Rows {
            file,
            unit: self.unit,
            sequence: self.sequences.then(String::new),
        })
    }
}

impl Format for TaxelFormat {
    fn csv(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        let forces = match self.unit {
            TaxelUnit::Newton => ["f_x", "f_y", "f_z"],
            TaxelUnit::Counts => ["f_x_counts", "f_y_counts", "f_z_counts"],
        };
        if let Some(estimator) = self.estimator.clone() {
            let sequence = self.sequences.then(String::new);
            return Ok(Box::new(wrench::Rows::csv(writer, estimator, sequence)?));
        }
        let sequence = self.sequences.then_some("sequence");
        let columns = sequence.into_iter().chain(["frame", "stamp", "element"]);
        Ok(self.rows(RowFile::csv(writer, columns.chain(forces))?))
    }

    fn jsonl(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        let file = RowFile::json_lines(writer);
        if let Some(estimator) = self.estimator.clone() {
            let sequence = self.sequences.then(String::new);
            return Ok(Box::new(wrench::Rows::new(file, estimator, sequence)));
        }
        Ok(self.rows(file))
    }

    fn mcap(&self, path: &Path) -> Result<Box<dyn Output>, CommandError> {
        let elements = self.facts.elements.len();
        Ok(Box::new(Mcap {
            writer: TaxelWriter::create(path, self.facts.clone())?,
            frame: TactileFrame::unloaded(elements),
            estimates: self.estimator.clone().map(Estimates::new),
        }))
    }
}

/// Columns of a row other than the force.
#[derive(Serialize)]
struct Row<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    sequence: Option<&'a str>,
    frame: u64,
    stamp: f64,
    element: usize,
}

/// Writer of one row per taxel and frame.
struct Rows {
    file: RowFile,
    unit: TaxelUnit,
    /// Name of the current sequence, if a column names sequences.
    sequence: Option<String>,
}

#[derive(Serialize)]
struct JsonRow<'a> {
    #[serde(flatten)]
    row: Row<'a>,
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

impl Output for Rows {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        for (element, reading) in frame.readings.iter().enumerate() {
            let force = &ForceRow::of(reading);
            let row = Row {
                sequence: self.sequence.as_deref(),
                frame: frame.sequence,
                stamp: frame.stamp,
                element,
            };
            let object = JsonRow {
                row,
                force: JsonForce::of(force, self.unit),
            };
            let place = (frame.sequence, frame.stamp, element);
            match &self.sequence {
                Some(sequence) => self.file.write_either(&(sequence, place, force), &object)?,
                None => self.file.write_either(&(place, force), &object)?,
            }
        }
        Ok(())
    }

    fn begin_sequence(&mut self, name: &str) -> Result<(), CommandError> {
        self.sequence = Some(name.to_owned());
        Ok(())
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(self.file.flush()?)
    }
}

/// ROS 2 messages in an MCAP file.
struct Mcap {
    writer: TaxelWriter,
    frame: TactileFrame,
    estimates: Option<Estimates<TaxelWrenchEstimator>>,
}

impl Output for Mcap {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        (self.frame.sequence, self.frame.stamp) = (frame.sequence, frame.stamp);
        for (force, reading) in self.frame.forces.iter_mut().zip(frame.readings) {
            *force = reading.force.unwrap_or(NO_FORCE);
        }
        self.writer.write(&self.frame)?;
        if let Some(estimates) = &mut self.estimates {
            let estimate = estimates.next(frame);
            self.writer
                .write_wrench(&wrench::message(frame.stamp, &estimate))?;
        }
        Ok(())
    }

    fn begin_sequence(&mut self, _: &str) -> Result<(), CommandError> {
        if let Some(estimates) = &mut self.estimates {
            estimates.restart();
        }
        Ok(())
    }

    fn warning(&self) -> Option<String> {
        self.estimates.as_ref().and_then(Estimates::warning)
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
