//! Limits the time for which an output buffers rows.

use super::frame_output::{FrameReadings, Output};
use feeler::sensor::image::Frame;
use feeler_console::CommandError;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Maximum age of a buffered row when the next row is written.
const PROMPT: Duration = Duration::from_secs(1);

/// Flushes rows older than [`PROMPT`] to the wrapped output, to limit the loss if the program is killed.
pub struct MaxAgeFlush {
    output: Box<dyn Output>,
    settled: Instant,
}

impl MaxAgeFlush {
    /// Wraps `output`.
    pub fn new(output: Box<dyn Output>) -> Self {
        let settled = Instant::now();
        Self { output, settled }
    }
}

impl Output for MaxAgeFlush {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        self.output.write(frame)?;
        if self.settled.elapsed() < PROMPT {
            return Ok(());
        }
        self.settled = Instant::now();
        self.output.settle()
    }

    fn write_picture(&mut self, frame: &Frame) -> Result<(), CommandError> {
        self.output.write_picture(frame)
    }

    fn begin_sequence(&mut self, name: &str) -> Result<(), CommandError> {
        self.output.begin_sequence(name)
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        self.output.flush()
    }

    fn warning(&self) -> Option<String> {
        self.output.warning()
    }

    fn finish(self: Box<Self>, whole: bool) -> Result<Option<PathBuf>, CommandError> {
        self.output.finish(whole)
    }
}
