//! Output to a file.

use super::frame_output::{FrameReadings, Output, partial};
use feeler::sensor::image::Frame;
use feeler_console::{CommandError, PartFile};
use std::path::PathBuf;

/// An output to a file that gets its final name only when it is complete.
pub struct FileOutput {
    name: String,
    output: Box<dyn Output>,
    part: PartFile,
    /// `true` if the last line may be incomplete.
    is_text: bool,
    /// Number of frames written.
    frames: u64,
}

impl FileOutput {
    /// Creates an output that writes to the partial file `part`, which is renamed to `name`. Set `is_text` if the last
    /// line may be incomplete.
    pub fn new(name: String, output: Box<dyn Output>, part: PartFile, is_text: bool) -> Self {
        Self {
            name,
            output,
            part,
            is_text,
            frames: 0,
        }
    }

    fn named<T>(&self, written: Result<T, CommandError>) -> Result<T, CommandError> {
        written.map_err(|error| format!("--output {}: {error}", self.name).into())
    }
}

impl Output for FileOutput {
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
            part.rename()?;
            return Ok(None);
        }
        if is_text {
            part.drop_torn_line();
        }
        let left = part.part().to_path_buf();
        match finished {
            // Report why the file is incomplete.
            Err(error) if whole => Err(partial(&error, &left)),
            _ => Ok(Some(left)),
        }
    }
}
