//! Where readings go: a table, lines of JSON, or MCAP.

use super::CommandError;
use super::prompt::Prompt;
use super::whole_rows::WholeRows;
use crate::part_file::{Outputs, PartFile};
use feeler::sensor::sensing::ElementReading;
use feeler_record::sensed::{MOMENTS, TACTILE};
use feeler_record::wire::Vector3;
use feeler_record::{MessageSink, Moments, SensedWriter, Tactile};
use glam::{DVec2, DVec3};
use serde::Serialize;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The readings of one frame.
pub struct FrameReadings<'a> {
    /// Number of the frame, from 0.
    pub sequence: u64,
    /// Time of the frame, s.
    pub stamp: f64,
    /// One for each element.
    pub readings: &'a [ElementReading],
}

/// Something that readings are written to.
pub trait Output: Send {
    /// Writes one frame.
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError>;
    /// Hands on what was collected, where that costs no room.
    fn flush(&mut self) -> Result<(), CommandError>;
    /// Hands on everything that was collected.
    fn settle(&mut self) -> Result<(), CommandError> {
        self.flush()
    }
    /// Writes what belongs at the end of what is `whole` or not: the partial file that is left, if one is.
    fn finish(self: Box<Self>, whole: bool) -> Result<Option<PathBuf>, CommandError>;
}

/// The output that `path` names by its extension, one of `outputs`, or a table on standard output.
pub fn open(
    path: Option<&Path>,
    mut outputs: Outputs,
    forces: bool,
) -> Result<Box<dyn Output>, CommandError> {
    let Some(path) = path else {
        let table = Table::new(Box::new(io::stdout()), forces)?;
        return Ok(Box::new(Prompt::new(Box::new(table))));
    };
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    if !["csv", "jsonl", "mcap"].contains(&extension) {
        let path = path.display();
        return Err(
            format!("--output {path}: expected a file ending in .csv, .jsonl or .mcap").into(),
        );
    }
    let part = outputs.create(path, "--output")?;
    let output: Box<dyn Output> = match extension {
        "csv" => Box::new(Table::new(Box::new(part.writer()?), forces)?),
        "jsonl" => Box::new(JsonLines::new(Box::new(part.writer()?), forces)),
        _ => Box::new(Mcap::create(part.part(), forces)?),
    };
    Ok(Box::new(Prompt::new(Box::new(Filed {
        name: path.display().to_string(),
        output,
        part,
        is_text: extension != "mcap",
        frames: 0,
    }))))
}

/// One element in one frame, as it is written; what there is not is left empty.
#[derive(Serialize)]
struct Row {
    frame: u64,
    stamp: f64,
    element: usize,
    integrated_gray: Option<f64>,
    u_x: Option<f64>,
    u_y: Option<f64>,
}

/// The force's part of a row.
#[derive(Serialize)]
struct ForceRow {
    f_x: Option<f64>,
    f_y: Option<f64>,
    f_z: Option<f64>,
}

impl Row {
    fn new(frame: &FrameReadings, element: usize, reading: &ElementReading) -> (Self, ForceRow) {
        let row = Self {
            frame: frame.sequence,
            stamp: frame.stamp,
            element,
            integrated_gray: Some(reading.integrated_gray).filter(|gray| gray.is_finite()),
            u_x: reading.displacement.map(|u| u.x),
            u_y: reading.displacement.map(|u| u.y),
        };
        let force = ForceRow {
            f_x: reading.force.map(|f| f.x),
            f_y: reading.force.map(|f| f.y),
            f_z: reading.force.map(|f| f.z),
        };
        (row, force)
    }
}

/// Comma-separated values, one row for each element and frame.
struct Table {
    writer: csv::Writer<WholeRows<Box<dyn Write + Send>>>,
    forces: bool,
}

impl Table {
    fn new(writer: Box<dyn Write + Send>, forces: bool) -> Result<Self, CommandError> {
        let writer = csv::WriterBuilder::new()
            .has_headers(false)
            .from_writer(WholeRows::new(writer));
        let mut table = Self { writer, forces };
        let moments = ["frame", "stamp", "element", "integrated_gray", "u_x", "u_y"];
        let with_forces = ["f_x", "f_y", "f_z"];
        let with_forces: &[&str] = if forces { &with_forces } else { &[] };
        table
            .writer
            .write_record(moments.iter().chain(with_forces))?;
        Ok(table)
    }
}

impl Output for Table {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        for (element, reading) in frame.readings.iter().enumerate() {
            let (row, force) = Row::new(frame, element, reading);
            match self.forces {
                true => self.writer.serialize((row, force))?,
                false => self.writer.serialize(row)?,
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(self.writer.flush()?)
    }

    fn finish(mut self: Box<Self>, _: bool) -> Result<Option<PathBuf>, CommandError> {
        self.flush().map(|()| None)
    }
}

/// The same rows as the table's, each a JSON object on a line of its own.
struct JsonLines {
    writer: WholeRows<Box<dyn Write + Send>>,
    forces: bool,
}

#[derive(Serialize)]
struct JsonRow {
    #[serde(flatten)]
    row: Row,
    #[serde(flatten)]
    force: Option<ForceRow>,
}

impl JsonLines {
    fn new(writer: Box<dyn Write + Send>, forces: bool) -> Self {
        Self {
            writer: WholeRows::new(writer),
            forces,
        }
    }
}

impl Output for JsonLines {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        for (element, reading) in frame.readings.iter().enumerate() {
            let (row, force) = Row::new(frame, element, reading);
            let force = self.forces.then_some(force);
            serde_json::to_writer(&mut self.writer, &JsonRow { row, force })?;
            self.writer.write_all(b"\n")?;
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(self.writer.flush()?)
    }

    fn finish(mut self: Box<Self>, _: bool) -> Result<Option<PathBuf>, CommandError> {
        self.flush().map(|()| None)
    }
}

/// An output to a file, which has its name only when it is whole.
struct Filed {
    name: String,
    output: Box<dyn Output>,
    part: PartFile,
    /// Whether a line may be torn.
    is_text: bool,
    /// Frames that were written.
    frames: u64,
}

impl Filed {
    fn named<T>(&self, written: Result<T, CommandError>) -> Result<T, CommandError> {
        written.map_err(|error| format!("--output {}: {error}", self.name).into())
    }
}

impl Output for Filed {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        self.frames += 1;
        let written = self.output.write(frame);
        self.named(written)
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        let flushed = self.output.flush();
        self.named(flushed)
    }

    fn settle(&mut self) -> Result<(), CommandError> {
        let settled = self.output.settle();
        self.named(settled)
    }

    fn finish(mut self: Box<Self>, whole: bool) -> Result<Option<PathBuf>, CommandError> {
        let flushed = self.flush();
        let Self {
            output,
            part,
            is_text,
            frames,
            ..
        } = *self;
        let finished = flushed.and_then(|()| output.finish(whole));
        if frames == 0 {
            part.discard();
            return Ok(None);
        }
        if whole && finished.is_ok() {
            return part.rename().map(|()| None);
        }
        if is_text {
            part.drop_torn_line();
        }
        let left = part.part().to_path_buf();
        match finished {
            // Why it is not whole, if it was to be.
            Err(error) if whole => Err(partial(&error, &left)),
            _ => Ok(Some(left)),
        }
    }
}

/// An error after which a part of the output is left.
pub fn partial(error: &CommandError, part: &Path) -> CommandError {
    format!("{error}; {} is partial", part.display()).into()
}

/// ROS 2 messages in an MCAP file: moments and, calibrated, forces.
struct Mcap {
    writer: SensedWriter,
    forces: bool,
}

impl Mcap {
    fn create(path: &Path, forces: bool) -> Result<Self, CommandError> {
        let writer = SensedWriter::create(path)?;
        Ok(Self { writer, forces })
    }
}

impl Output for Mcap {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        let &FrameReadings {
            sequence,
            stamp,
            readings,
        } = frame;
        let along = |place: fn(&ElementReading) -> Option<DVec2>, axis: usize| {
            let readings = readings.iter();
            readings
                .map(|r| place(r).map_or(f64::NAN, |p| p[axis]))
                .collect()
        };
        self.writer.write(
            MOMENTS,
            &Moments {
                sequence,
                stamp,
                integrated_gray: readings.iter().map(|r| r.integrated_gray).collect(),
                displacement_x: along(|r| r.displacement, 0),
                displacement_y: along(|r| r.displacement, 1),
                centroid_x: along(|r| r.centroid, 0),
                centroid_y: along(|r| r.centroid, 1),
            },
        )?;
        if self.forces {
            // A force that there is not is not a number in each component.
            let force = |r: &ElementReading| Vector3::from(r.force.unwrap_or(DVec3::NAN));
            self.writer.write(
                TACTILE,
                &Tactile {
                    sequence,
                    stamp,
                    forces: readings.iter().map(force).collect(),
                },
            )?;
        }
        Ok(())
    }

    /// Not for every frame: each time costs 0.6 KB.
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
