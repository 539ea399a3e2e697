//! File formats of readings.

use super::filed::FileOutput;
use super::frame_output::{FrameReadings, Output};
use super::prompt::MaxAgeFlush;
use super::row_file::{RowFile, TextWriter};
use feeler::sensor::image::Frame;
use feeler_console::{CommandError, Outputs};
use feeler_record::{Image, MessageSink, SensedWriter, topics};
use std::io;
use std::path::{Path, PathBuf};

/// An output format for one kind of data, which converts frames to rows or messages.
pub trait Format: Send {
    /// Returns the column names of a table, without the sequence column.
    fn columns(&self) -> Vec<&'static str>;
    /// Returns `true` if each row contains the name of its sequence.
    fn names_sequences(&self) -> bool {
        false
    }
    /// Writes the rows of a frame.
    fn write_rows(&mut self, frame: &FrameReadings, file: &mut RowFile)
    -> Result<(), CommandError>;

    /// Creates an MCAP file with the topics of the messages.
    fn create_mcap(&self, path: &Path) -> Result<SensedWriter, CommandError>;
    /// Returns the finger whose images are recorded in an MCAP file, or `None` if images are not recorded.
    fn recorded_finger(&self) -> Option<usize> {
        None
    }
    /// Writes the messages of a frame.
    fn write_messages(
        &mut self,
        frame: &FrameReadings,
        writer: &mut SensedWriter,
    ) -> Result<(), CommandError>;

    /// Starts a new sequence: later frames are independent of earlier ones.
    fn begin_sequence(&mut self) {}
    /// Returns a warning about the written data, if any.
    fn warning(&self) -> Option<String> {
        None
    }
}

/// Rows of text.
struct Rows {
    file: RowFile,
    format: Box<dyn Format>,
}

impl Rows {
    fn csv(writer: TextWriter, format: Box<dyn Format>) -> Result<Self, CommandError> {
        let file = RowFile::csv(writer, &format.columns(), format.names_sequences())?;
        Ok(Self { file, format })
    }

    fn json_lines(writer: TextWriter, format: Box<dyn Format>) -> Self {
        let file = RowFile::json_lines(writer, format.names_sequences());
        Self { file, format }
    }
}

impl Output for Rows {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        self.format.write_rows(frame, &mut self.file)
    }

    fn begin_sequence(&mut self, name: &str) -> Result<(), CommandError> {
        self.file.begin_sequence(name);
        self.format.begin_sequence();
        Ok(())
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(self.file.flush()?)
    }

    fn warning(&self) -> Option<String> {
        self.format.warning()
    }
}

/// ROS 2 messages in an MCAP file.
struct Mcap {
    writer: SensedWriter,
    /// Finger and buffer of the recorded images, or `None` if images are not recorded.
    pictures: Option<(usize, Image)>,
    format: Box<dyn Format>,
}

impl Mcap {
    fn create(path: &Path, format: Box<dyn Format>) -> Result<Self, CommandError> {
        let pictures = format.recorded_finger();
        Ok(Self {
            writer: format.create_mcap(path)?,
            pictures: pictures.map(|finger| (finger, Image::of_finger(finger))),
            format,
        })
    }
}

impl Output for Mcap {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        self.format.write_messages(frame, &mut self.writer)
    }

    fn write_picture(&mut self, frame: &Frame) -> Result<(), CommandError> {
        if let Some((finger, image)) = &mut self.pictures {
            image.fill(frame)?;
            self.writer.write(topics::image(*finger), image)?;
        }
        Ok(())
    }

    fn begin_sequence(&mut self, _: &str) -> Result<(), CommandError> {
        self.format.begin_sequence();
        Ok(())
    }

    /// Does nothing, because each flush adds 0.6 KB to the file.
    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(())
    }

    fn settle(&mut self) -> Result<(), CommandError> {
        Ok(self.writer.flush()?)
    }

    fn warning(&self) -> Option<String> {
        self.format.warning()
    }

    fn finish(self: Box<Self>, _: bool) -> Result<Option<PathBuf>, CommandError> {
        Ok(self.writer.finish().map(|()| None)?)
    }
}

/// Opens the output whose file format is given by the extension of `path`, or a table on standard output if there is no
/// path.
pub fn open(
    path: Option<&Path>,
    mut outputs: Outputs,
    format: Box<dyn Format>,
) -> Result<Box<dyn Output>, CommandError> {
    let Some(path) = path else {
        let table = Rows::csv(Box::new(io::stdout()), format)?;
        return Ok(Box::new(MaxAgeFlush::new(Box::new(table))));
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
        "csv" => Box::new(Rows::csv(Box::new(part.writer()?), format)?),
        "jsonl" => Box::new(Rows::json_lines(Box::new(part.writer()?), format)),
        _ => Box::new(Mcap::create(part.part(), format)?),
    };
    let name = path.display().to_string();
    let filed = FileOutput::new(name, output, part, extension != "mcap");
    Ok(Box::new(MaxAgeFlush::new(Box::new(filed))))
}
