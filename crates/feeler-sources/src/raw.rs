//! A camera that reads a stream of raw grey frames, such as the output of `ffmpeg … -f rawvideo -pix_fmt gray -`.

use feeler::sensor::image::{Camera, CameraError, Frame, check_frame_size};
use std::io::{ErrorKind, Read};

/// Reads consecutive frames of `width * height` bytes. Frame k (from 0) has the stamp `k / rate`, as the stream
/// contains no times.
///
/// A stream that ends within a frame returns [`CameraError::Unreadable`] for that frame, then [`CameraError::Ended`].
#[derive(Debug)]
pub struct RawFrames<R> {
    stream: R,
    size: (usize, usize),
    rate: f64,
    next: u64,
    ended: bool,
}

impl<R: Read> RawFrames<R> {
    /// Creates a camera that reads frames of `size` (columns, rows) px at `rate` Hz from `stream`.
    pub fn new(stream: R, size: (usize, usize), rate: f64) -> Self {
        Self {
            stream,
            size,
            rate,
            next: 0,
            ended: false,
        }
    }

    /// Fills `pixels` until the stream ends; returns the number of bytes read.
    fn fill(&mut self, pixels: &mut [u8]) -> std::io::Result<usize> {
        let mut filled = 0;
        while filled < pixels.len() {
            match self.stream.read(&mut pixels[filled..]) {
                Ok(0) => break,
                Ok(read) => filled += read,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(filled)
    }
}

impl<R: Read> Camera for RawFrames<R> {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        check_frame_size(self.size, frame)?;
        let index = self.next;
        if self.ended {
            return Err(CameraError::Ended { count: index });
        }
        let expected = frame.picture.pixels.len();
        let filled = self.fill(&mut frame.picture.pixels);
        let filled = filled.map_err(|e| CameraError::Failed(format!("frame {index}: {e}")))?;
        if filled < expected {
            self.ended = true;
            if filled == 0 {
                return Err(CameraError::Ended { count: index });
            }
            return Err(CameraError::Unreadable {
                name: format!("frame {index}"),
                reason: format!("the stream ended after {filled} of its {expected} bytes"),
            });
        }
        frame.sequence = index;
        frame.stamp = index as f64 / self.rate;
        self.next += 1;
        Ok(())
    }
}
