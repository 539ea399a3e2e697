//! A camera behind the seam that takes again the pictures on record.

use super::channels::nanoseconds;
use super::error::RecordError;
use super::picture_reader::PictureReader;
use super::recording::{PictureAt, Recording};
use feeler::sensor::camera::{Camera, CameraError, check_frame_size};
use feeler::sensor::frame::{Frame, Picture};
use std::fs::File;
use std::io::{Read, Seek};
use std::path::Path;

/// Gives at every control step the picture that one finger's sensor saw then, with its sequence number and
/// its whole stamp, which are those of the tactile frame on record.
///
/// A step that saw no new picture sees the same again. Pictures are read from the file as they are asked
/// for.
#[derive(Debug)]
pub struct RecordedCamera<F = File> {
    file: PictureReader<F>,
    /// Sequence number and stamp (s) of what each step saw.
    seen: std::vec::IntoIter<(u64, f64)>,
    pictures: std::vec::IntoIter<PictureAt>,
    /// The newest picture and its sequence number.
    newest: Option<(u64, Picture)>,
    count: u64,
}

impl RecordedCamera {
    /// The camera in the fingertip of `finger`, as in the `recording` that was read from `path`.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open(path: &Path, recording: &Recording, finger: usize) -> Result<Self, RecordError> {
        let file = File::open(path).map_err(|source| RecordError::File {
            path: path.to_path_buf(),
            source,
        })?;
        Ok(Self::new(file, recording, finger))
    }
}

impl<F: Read + Seek> RecordedCamera<F> {
    /// The camera in the fingertip of `finger`, as in the `recording` that was read from `file`; without
    /// any picture if there is no such finger.
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

    /// Columns and rows of the next picture, px; none if there are no more.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn picture_size(&mut self) -> Result<Option<(usize, usize)>, CameraError> {
        let Some(&at) = self.pictures.as_slice().first() else {
            return Ok(None);
        };
        let picture = self.file.read(at).map_err(CameraError::Failed)?;
        Ok(Some((picture.width, picture.height)))
    }

    /// The next picture on record, which must be that of `stamp`, s.
    fn next_picture(&mut self, stamp: f64) -> Result<Picture, CameraError> {
        let expected = nanoseconds(stamp);
        let at = self.pictures.next();
        let at = at
            .filter(|at| Some(at.log_time) == expected)
            .ok_or_else(|| {
                let found = at.map(|at| format!("that of {} ns is next", at.log_time));
                let found = found.unwrap_or_else(|| "there are no more".into());
                CameraError::Failed(format!(
                    "the picture of {stamp} s expected on record, {found}"
                ))
            })?;
        self.file
            .read(at)
            .map_err(|reason| CameraError::Failed(format!("the picture of {stamp} s: {reason}")))
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
