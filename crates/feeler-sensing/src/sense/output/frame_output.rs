//! Interface of a destination for readings.

use feeler::sensor::forces::{ElementReading, NO_FORCE};
use feeler::sensor::image::Frame;
use feeler::sensor::track::TrackedMarker;
use feeler_console::CommandError;
use glam::DVec3;
use std::path::{Path, PathBuf};

/// Readings of one frame.
pub struct FrameReadings<'a> {
    /// Number of the frame, from 0.
    pub sequence: u64,
    /// Time of the frame (s).
    pub stamp: f64,
    /// One reading per element.
    pub readings: &'a [ElementReading],
    /// One marker per element if markers are tracked, otherwise empty.
    pub markers: &'a [TrackedMarker],
}

impl FrameReadings<'_> {
    /// Force on each element in its frame, N (counts for some taxel arrays); [`NO_FORCE`] if it is unknown.
    pub fn forces(&self) -> impl Iterator<Item = DVec3> {
        self.readings.iter().map(|r| r.force.unwrap_or(NO_FORCE))
    }
}

/// A destination for readings.
pub trait Output: Send {
    /// Writes one frame.
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError>;
    /// Writes the image of a frame if images are recorded. Called before the frame itself is written.
    fn write_picture(&mut self, _frame: &Frame) -> Result<(), CommandError> {
        Ok(())
    }
    /// Starts a new sequence with this name: later frames are independent of earlier ones.
    fn begin_sequence(&mut self, _name: &str) -> Result<(), CommandError> {
        Ok(())
    }
    /// Writes buffered data to the file, except in formats in which each flush enlarges the file.
    fn flush(&mut self) -> Result<(), CommandError>;
    /// Writes all buffered data to the file, in any format.
    fn settle(&mut self) -> Result<(), CommandError> {
        self.flush()
    }
    /// Returns a warning about the written data, if any.
    fn warning(&self) -> Option<String> {
        None
    }
    /// Completes the output, or marks it as partial if `whole` is `false`. Returns the path of the partial file that
    /// remains, if any.
    fn finish(mut self: Box<Self>, _whole: bool) -> Result<Option<PathBuf>, CommandError> {
        self.flush().map(|()| None)
    }
}

/// Appends the path of the remaining partial file to an error.
pub fn partial(error: &CommandError, part: &Path) -> CommandError {
    format!("{error}; {} is partial", part.display()).into()
}
