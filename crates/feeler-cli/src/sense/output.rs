//! Where readings go: a table, lines of JSON, or MCAP.

use super::CommandError;
use super::prompt::Prompt;
use super::row_file::RowFile;
use crate::part_file::{Outputs, PartFile};
use feeler::sensor::frame::Frame;
use feeler::sensor::sensing::ElementReading;
use feeler::sensor::track::TrackedMarker;
use feeler_record::sensed::{MOMENTS, TACTILE};
use feeler_record::wire::Vector3;
use feeler_record::{Image, MessageSink, Moments, SensedWriter, Tactile, topics};
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
    /// One for each element where markers are tracked.
    pub markers: &'a [TrackedMarker],
}

/// Something that readings are written to.
pub trait Output: Send {
    /// Writes one frame.
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError>;
    /// Writes the picture of a frame, where pictures are kept; before the frame itself.
    fn write_picture(&mut self, _frame: &Frame) -> Result<(), CommandError> {
        Ok(())
    }
    /// The frames from here on are of another sequence, of this name, and have nothing to do with those before.
    fn begin_sequence(&mut self, _name: &str) -> Result<(), CommandError> {
        Ok(())
    }
    /// Hands on what was collected, where that costs no room.
    fn flush(&mut self) -> Result<(), CommandError>;
    /// Hands on everything that was collected.
    fn settle(&mut self) -> Result<(), CommandError> {
        self.flush()
    }
    /// What is to be said of all that was written, if anything is.
    fn warning(&self) -> Option<String> {
        None
    }
    /// Writes what belongs at the end of what is `whole` or not: the partial file that is left, if one is.
    fn finish(mut self: Box<Self>, _whole: bool) -> Result<Option<PathBuf>, CommandError> {
        self.flush().map(|()| None)
    }
}

/// What rows are written to.
pub type RowWriter = Box<dyn Write + Send>;

/// What outputs say, and how, in each of the formats.
pub trait Format {
    /// Comma-separated values.
    fn csv(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError>;
    /// Lines of JSON.
    fn jsonl(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError>;
    /// An MCAP file.
    fn mcap(&self, path: &Path) -> Result<Box<dyn Output>, CommandError>;
}

/// What pictures say: moments and, calibrated, forces.
pub struct OfPictures {
    /// Whether there are forces.
    pub forces: bool,
    /// The finger whose pictures are kept, if they are.
    pub pictures: Option<usize>,
}

impl Format for OfPictures {
    fn csv(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        let moments = ["frame", "stamp", "element", "integrated_gray", "u_x", "u_y"];
        let forces: &[&str] = if self.forces {
            &["f_x", "f_y", "f_z"]
        } else {
            &[]
        };
        let columns = moments.iter().chain(forces).copied();
        Ok(Box::new(Rows {
            file: RowFile::csv(writer, columns)?,
            forces: self.forces,
        }))
    }

    fn jsonl(&self, writer: RowWriter) -> Result<Box<dyn Output>, CommandError> {
        Ok(Box::new(Rows {
            file: RowFile::json_lines(writer),
            forces: self.forces,
        }))
    }

    fn mcap(&self, path: &Path) -> Result<Box<dyn Output>, CommandError> {
        Ok(Box::new(Mcap::create(path, self)?))
    }
}

/// The output that `path` names by its extension, one of `outputs`, or a table on standard output.
pub fn open(
    path: Option<&Path>,
    mut outputs: Outputs,
    format: &dyn Format,
) -> Result<Box<dyn Output>, CommandError> {
    let Some(path) = path else {
        let table = format.csv(Box::new(io::stdout()))?;
        return Ok(Box::new(Prompt::new(table)));
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
        "csv" => format.csv(Box::new(part.writer()?))?,
        "jsonl" => format.jsonl(Box::new(part.writer()?))?,
        _ => format.mcap(part.part())?,
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
pub struct ForceRow {
    pub f_x: Option<f64>,
    pub f_y: Option<f64>,
    pub f_z: Option<f64>,
}

impl ForceRow {
    /// That of a reading.
    pub fn of(reading: &ElementReading) -> Self {
        Self {
            f_x: reading.force.map(|f| f.x),
            f_y: reading.force.map(|f| f.y),
            f_z: reading.force.map(|f| f.z),
        }
    }
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
        (row, ForceRow::of(reading))
    }
}

/// One row for each element and frame.
struct Rows {
    file: RowFile,
    forces: bool,
}

/// The fields of a row, which a table cannot flatten.
#[derive(Serialize)]
struct JsonRow<'a> {
    #[serde(flatten)]
    row: &'a Row,
    #[serde(flatten)]
    force: &'a ForceRow,
}

impl Output for Rows {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        for (element, reading) in frame.readings.iter().enumerate() {
            let (row, force) = &Row::new(frame, element, reading);
            match self.forces {
                true => self
                    .file
                    .write_either(&(row, force), &JsonRow { row, force })?,
                false => self.file.write(row)?,
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(self.file.flush()?)
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

    fn write_picture(&mut self, frame: &Frame) -> Result<(), CommandError> {
        let written = self.output.write_picture(frame);
        self.named(written)
    }

    fn begin_sequence(&mut self, name: &str) -> Result<(), CommandError> {
        self.output.begin_sequence(name)
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        let flushed = self.output.flush();
        self.named(flushed)
    }

    fn settle(&mut self) -> Result<(), CommandError> {
        let settled = self.output.settle();
        self.named(settled)
    }

    fn warning(&self) -> Option<String> {
        self.output.warning()
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

/// The pictures of a sensor on their way into an MCAP file; none where they are not kept.
pub struct Pictures(Option<(usize, Image)>);

impl Pictures {
    /// Those of `finger`, if one is named.
    pub fn of(finger: Option<usize>) -> Self {
        Self(finger.map(|finger| (finger, Image::of_finger(finger))))
    }

    /// Writes the picture of `frame`.
    pub fn write(&mut self, frame: &Frame, writer: &mut SensedWriter) -> Result<(), CommandError> {
        if let Some((finger, image)) = &mut self.0 {
            image.fill(frame)?;
            writer.write(topics::image(*finger), image)?;
        }
        Ok(())
    }
}

/// ROS 2 messages in an MCAP file: moments and, calibrated, forces; pictures where they are kept.
struct Mcap {
    writer: SensedWriter,
    pictures: Pictures,
    forces: bool,
}

impl Mcap {
    fn create(path: &Path, format: &OfPictures) -> Result<Self, CommandError> {
        Ok(Self {
            writer: SensedWriter::create(path, format.pictures)?,
            pictures: Pictures::of(format.pictures),
            forces: format.forces,
        })
    }
}

/// What a frame says before any calibration.
pub fn moments(frame: &FrameReadings) -> Moments {
    let &FrameReadings {
        sequence,
        stamp,
        readings,
        ..
    } = frame;
    let along = |place: fn(&ElementReading) -> Option<DVec2>, axis: usize| {
        let readings = readings.iter();
        readings
            .map(|r| place(r).map_or(f64::NAN, |p| p[axis]))
            .collect()
    };
    Moments {
        sequence,
        stamp,
        integrated_gray: readings.iter().map(|r| r.integrated_gray).collect(),
        displacement_x: along(|r| r.displacement, 0),
        displacement_y: along(|r| r.displacement, 1),
        centroid_x: along(|r| r.centroid, 0),
        centroid_y: along(|r| r.centroid, 1),
    }
}

impl Output for Mcap {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        self.writer.write(MOMENTS, &moments(frame))?;
        let &FrameReadings {
            sequence,
            stamp,
            readings,
            ..
        } = frame;
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

    fn write_picture(&mut self, frame: &Frame) -> Result<(), CommandError> {
        self.pictures.write(frame, &mut self.writer)
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
