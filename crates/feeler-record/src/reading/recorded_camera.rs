//! A camera that plays back the recorded images of one finger.

use super::picture_reader::PictureReader;
use super::recording::{PictureAt, Recording};
use crate::error::RecordError;
use crate::messages::channels::nanoseconds;
use feeler::sensor::image::{Camera, CameraError, Frame, Picture, check_frame_size};
use std::fs::File;
use std::io::{Read, Seek};
use std::path::Path;

/// Camera that returns at every control step the image used by one finger's sensor at that step, with the sequence
/// number and the exact stamp of the recorded tactile frame.
///
/// A step without a new image returns the previous one again. Images are read from the file on demand.
#[derive(Debug)]
pub struct RecordedCamera<F = File> {
    file: PictureReader<F>,
    /// Sequence number and stamp (s) of the image used at each step.
    seen: std::vec::IntoIter<(u64, f64)>,
    pictures: std::vec::IntoIter<PictureAt>,
    /// Latest image and its sequence number.
    newest: Option<(u64, Picture)>,
    count: u64,
}

impl RecordedCamera {
    /// Opens the recording at `path` as the camera of `finger`. `recording` must have been read from the same file.
    ///
    /// # Errors
    /// If the file cannot be opened.
    pub fn open(path: &Path, recording: &Recording, finger: usize) -> Result<Self, RecordError> {
        let file = File::open(path).map_err(RecordError::file(path))?;
        Ok(Self::new(file, recording, finger))
    }
}

impl<F: Read + Seek> RecordedCamera<F> {
    /// Creates the camera of `finger`. `recording` must have been read from `file`. If the recording has no such
    /// finger, the camera has no images.
    pub fn new(file: F, recording: &Recording, finger: usize) -> Self {
        let record = recording.fingers.get(finger);
        let seen = record.map_or(Vec::new(), |record| {
            let frames = record.tactile.iter();
            frames.map(|frame| (frame.sequence, frame.stamp)).collect()
        });
        let pictures = record.map_or(Vec::new(), |record| record.pictures.clone());
        Self {
            file: PictureReader::new(file),
            seen: seen.into_iter(),
            pictures: pictures.into_iter(),
            newest: None,
            count: 0,
        }
    }

    /// Width and height of the next image (px), or `None` if there are no more.
    ///
    /// # Errors
    /// If the image cannot be read.
    pub fn picture_size(&mut self) -> Result<Option<(usize, usize)>, CameraError> {
        let Some(&at) = self.pictures.as_slice().first() else {
            return Ok(None);
        };
        let picture = self.file.read(at).map_err(CameraError::Failed)?;
        Ok(Some((picture.width, picture.height)))
    }

    /// Reads the next recorded image, which must have the time `stamp` (s).
    fn next_picture(&mut self, stamp: f64) -> Result<Picture, CameraError> {
        let expected = nanoseconds(stamp);
        let at = self.pictures.next();
        let at = at
            .filter(|at| Some(at.log_time) == expected)
            .ok_or_else(|| {
                let found = at.map(|at| format!("found the image at {} ns", at.log_time));
                let found = found.unwrap_or_else(|| "found no more images".into());
                CameraError::Failed(format!("expected the recorded image at {stamp} s, {found}"))
            })?;
        self.file
            .read(at)
            .map_err(|reason| CameraError::Failed(format!("image at {stamp} s: {reason}")))
    }
}

impl<F: Read + Seek> Camera for RecordedCamera<F> {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        let count = self.count;
        let (sequence, stamp) = self.seen.next().ok_or(CameraError::Ended { count })?;
        let held = self.newest.take().filter(|(held, _)| *held == sequence);
        let picture = match held {
            Some((_, picture)) => picture,
            None => self.next_picture(stamp)?,
        };
        check_frame_size((picture.width, picture.height), frame)?;
        frame.picture.pixels.copy_from_slice(&picture.pixels);
        (frame.sequence, frame.stamp) = (sequence, stamp);
        self.newest = Some((sequence, picture));
        self.count += 1;
        Ok(())
    }
}
