//! Decodes Motion JPEG to greyscale images, scaled down while decoding.

use crate::fit::{AreaAverage, Fit};
use crate::jpeg;
use feeler::sensor::image::Picture;
use rusty_jpeg::decode::{CodingProcess, Decoder, PlanarComponent};

/// Error of decoding a Motion JPEG frame.
#[derive(Debug, thiserror::Error)]
pub enum MotionJpegError {
    /// The frame is not a valid JPEG image.
    #[error("expected a JPEG image: {0}")]
    Decode(String),
    /// The image is truncated.
    #[error("the image is truncated: {bytes} bytes without the end marker of a JPEG image")]
    Truncated {
        /// Length of the frame, bytes.
        bytes: usize,
    },
    /// The image does not have the size announced by the camera.
    #[error("expected {}x{} px, got {}x{} px", expected.0, expected.1, found.0, found.1)]
    Size {
        /// Width and height announced by the camera, px.
        expected: (usize, usize),
        /// Width and height of the image, px.
        found: (usize, usize),
    },
}

/// Decodes the frames of one camera to greyscale images of one size.
///
/// Grey values are the luma of the JPEG data (Rec. 601); colours are not converted. Images that are scaled to 1/2,
/// 1/4 or 1/8 are decoded with shorter cosine transforms (DCT scaling) and then averaged to the wanted size
/// ([`Fit`]).
pub struct MotionJpeg {
    fit: Fit,
    denominator: usize,
    average: AreaAverage,
    /// Plane buffers of the latest image, to be reused.
    planes: Vec<Vec<u8>>,
}

impl MotionJpeg {
    /// Creates a decoder that scales images by `fit`.
    pub fn new(fit: Fit) -> Self {
        let denominator = fit.denominator();
        Self {
            fit,
            denominator,
            average: AreaAverage::new(&fit, denominator),
            planes: Vec::new(),
        }
    }

    /// Decodes one frame into `picture`, which is resized to the wanted size.
    ///
    /// # Errors
    /// If the frame is not one complete sequential JPEG image of the offered size; `picture` is then unchanged.
    /// Progressive images are rejected because cameras do not send them and decoding their scans can take minutes.
    pub fn decode(&mut self, bytes: &[u8], picture: &mut Picture) -> Result<(), MotionJpegError> {
        let failed = |error: rusty_jpeg::decode::Error| MotionJpegError::Decode(error.to_string());
        if !jpeg::is_whole(bytes) {
            return Err(match jpeg::is_jpeg(bytes) {
                true => MotionJpegError::Truncated { bytes: bytes.len() },
                false => MotionJpegError::Decode("no start marker".into()),
            });
        }
        let expected = self.fit.offered();
        let mut decoder = Decoder::new(bytes);
        // Each camera has one thread; a thread pool of the library would slow down the others.
        decoder.set_single_threaded(true);
        decoder.set_max_decoding_buffer_size(4 * expected.0 * expected.1);
        decoder.recycle_planes(std::mem::take(&mut self.planes));
        decoder.read_info().map_err(failed)?;
        let info = decoder
            .info()
            .ok_or_else(|| MotionJpegError::Decode("no image".into()))?;
        let found = (usize::from(info.width), usize::from(info.height));
        if found != expected {
            return Err(MotionJpegError::Size { expected, found });
        }
        if info.coding_process != CodingProcess::DctSequential {
            let words = "expected a sequential image, as sent by cameras";
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

    /// Copies or averages decoded luma into `picture`.
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
