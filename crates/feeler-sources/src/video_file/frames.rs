//! Random access to the frames of a video file.

use super::{VideoFile, VideoFileError};
use feeler::sensor::image::{Camera, CameraError, Frame, Picture};
use std::path::{Path, PathBuf};

/// Frames of a video file, by index from 0.
///
/// Frames read in increasing order are decoded once; going back decodes from the beginning.
#[derive(Debug)]
pub struct VideoFrames {
    path: PathBuf,
    stamps: Vec<f64>,
    frame: Frame,
    /// `true` if `frame` contains a frame of the video.
    is_read: bool,
    video: Option<VideoFile>,
}

impl VideoFrames {
    /// Opens the video at `path` and decodes it once to read the times of its frames.
    ///
    /// # Errors
    /// If the file cannot be decoded to its end.
    pub fn open(path: &Path) -> Result<Self, VideoFileError> {
        let mut video = VideoFile::open(path)?;
        let (width, height) = video.size();
        let mut frame = Frame::black(width, height);
        let mut stamps = Vec::new();
        loop {
            match video.capture(&mut frame) {
                Ok(()) => stamps.push(frame.stamp),
                Err(CameraError::Ended { .. }) => break,
                Err(error) => return Err(error.into()),
            }
        }
        Ok(Self {
            path: path.to_path_buf(),
            stamps,
            frame,
            is_read: false,
            video: None,
        })
    }

    /// Presentation time of each frame, s.
    pub fn stamps(&self) -> &[f64] {
        &self.stamps
    }

    /// Returns frame `index`.
    ///
    /// # Errors
    /// If there is no such frame, or the file can no longer be decoded.
    pub fn read(&mut self, index: usize) -> Result<&Picture, VideoFileError> {
        let index = index as u64;
        if self.is_read && self.frame.sequence > index {
            self.close();
        }
        let video = match &mut self.video {
            Some(video) => video,
            none => none.insert(VideoFile::open(&self.path)?),
        };
        while !self.is_read || self.frame.sequence < index {
            self.is_read = false;
            video.capture(&mut self.frame)?;
            self.is_read = true;
        }
        Ok(&self.frame.picture)
    }

    /// Stops decoding. The next frame that is read is decoded from the beginning.
    pub fn close(&mut self) {
        self.video = None;
        self.is_read = false;
    }
}
