//! Decodes Motion JPEG to grey pictures, scaled down while decoding.

use crate::fit::{AreaAverage, Fit};
use crate::jpeg;
use feeler::sensor::frame::Picture;
use rusty_jpeg::decode::{CodingProcess, Decoder, PlanarComponent};

/// Why there is no picture in a frame of Motion JPEG.
#[derive(Debug, thiserror::Error)]
pub enum MotionJpegError {
    /// The frame is no JPEG picture, or a damaged one.
    #[error("a JPEG picture expected: {0}")]
    Decode(String),
    /// The frame ends within the picture.
    #[error("the picture is truncated: {bytes} bytes without the end mark of a JPEG picture")]
    Truncated {
        /// Length of the frame.
        bytes: usize,
    },
    /// The picture has another size than the camera promised.
    #[error("{}x{} px expected, got {}x{} px", expected.0, expected.1, found.0, found.1)]
    Size {
        /// Columns and rows that the camera promised, px.
        expected: (usize, usize),
        /// Columns and rows of the picture, px.
        found: (usize, usize),
    },
}

/// Decodes the frames of one camera to grey pictures of one size.
///
/// Grey is the luma of the JPEG file (Rec. 601); colours are not converted. A picture that is scaled to 1/2, 1/4 or 1/8 is decoded by shorter
/// cosine transforms (DCT scaling), and its areas are then averaged to the wanted size ([`Fit`]).
pub struct MotionJpeg {
    fit: Fit,
    denominator: usize,
    average: AreaAverage,
    /// Memory of the last picture's planes, for the next.
    planes: Vec<Vec<u8>>,
}

impl MotionJpeg {
    /// Decodes pictures as `fit` says.
    pub fn new(fit: Fit) -> Self {
        let denominator = fit.denominator();
        Self {
            fit,
            denominator,
            average: AreaAverage::new(&fit, denominator),
            planes: Vec::new(),
        }
    }

    /// Decodes one frame into `picture`, which gets the wanted size.
    ///
    /// # Errors
    /// If the frame is not one whole sequential JPEG picture of the offered size; `picture` is then unchanged. Progressive pictures are
    /// rejected, as no camera sends them and their scans can take minutes.
    pub fn decode(&mut self, bytes: &[u8], picture: &mut Picture) -> Result<(), MotionJpegError> {
        let failed = |error: rusty_jpeg::decode::Error| MotionJpegError::Decode(error.to_string());
        if !jpeg::is_whole(bytes) {
            return Err(match jpeg::is_jpeg(bytes) {
                true => MotionJpegError::Truncated { bytes: bytes.len() },
                false => MotionJpegError::Decode("no start mark".into()),
            });
        }
        let expected = self.fit.offered();
        let mut decoder = Decoder::new(bytes);
        // One camera has one thread; the library's own would take the processors of others.
        decoder.set_single_threaded(true);
        decoder.set_max_decoding_buffer_size(4 * expected.0 * expected.1);
        decoder.recycle_planes(std::mem::take(&mut self.planes));
        decoder.read_info().map_err(failed)?;
        let info = decoder
            .info()
            .ok_or_else(|| MotionJpegError::Decode("no picture".into()))?;
        let found = (usize::from(info.width), usize::from(info.height));
        if found != expected {
            return Err(MotionJpegError::Size { expected, found });
        }
        if info.coding_process != CodingProcess::DctSequential {
            let words = "expected a sequential picture, as cameras send it";
            return Err(MotionJpegError::Decode(words.into()));
        }
        let scaled = self.fit.scaled(self.denominator);
        let [columns, rows] =
            [scaled.0, scaled.1].map(|side| u16::try_from(side).unwrap_or(u16::MAX));
        decoder.scale(columns, rows).map_err(failed)?;
        let decoded = decoder.decode_planar().map_err(failed)?;
        let luma = decoded.components.first();
        let result = match luma.filter(|luma| (luma.width, luma.height) == scaled) {
            Some(luma) => {
                self.fill(luma, picture);
                Ok(())
            }
            None => Err(MotionJpegError::Decode("its luma is subsampled".into())),
        };
        self.planes = decoded.into_planes();
        result
    }

    /// Puts decoded luma into `picture`.
    fn fill(&mut self, luma: &PlanarComponent, picture: &mut Picture) {
        let (width, height) = self.fit.wanted();
        (picture.width, picture.height) = (width, height);
        picture.pixels.resize(width * height, 0);
        if (luma.width, luma.height) != (width, height) {
            let pixels = &mut picture.pixels;
            self.average.average(&luma.data, luma.stride, pixels);
            return;
        }
        let rows = picture.pixels.chunks_exact_mut(width.max(1));
        for (row, line) in rows.zip(luma.data.chunks(luma.stride.max(1))) {
            if let Some(line) = line.get(..width) {
                row.copy_from_slice(line);
            }
        }
    }
}

#[cfg(test)]
#[path = "motion_jpeg/tests.rs"]
mod tests;
