//! Pixel formats of a camera and their conversion to grey. Independent of hardware.

use crate::fit::{AreaAverage, Fit};
use crate::motion_jpeg::MotionJpeg;
use feeler::sensor::image::Picture;
use linuxvideo::format::PixelFormat;

/// Pixel format of a camera's images.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    Gray,
    Yuyv,
    MotionJpeg,
}

impl Coding {
    /// All formats, in order of preference.
    pub(super) const ALL: [Self; 3] = [Self::Gray, Self::Yuyv, Self::MotionJpeg];

    /// Code of the format in Video4Linux.
    pub(super) fn pixels(self) -> PixelFormat {
        match self {
            Self::Gray => PixelFormat::from_fourcc(*b"GREY"),
            Self::Yuyv => PixelFormat::YUYV,
            Self::MotionJpeg => PixelFormat::MJPG,
        }
    }
}

/// Converts the camera's bytes to greyscale images of the wanted size.
pub(super) enum Decoder {
    /// Uncompressed pixels, in rows `stride` bytes apart.
    Raw {
        coding: Coding,
        stride: usize,
        /// Buffer of the camera's size and the scaling; `None` if the camera's images have the wanted size.
        scaled: Option<(Picture, AreaAverage)>,
    },
    /// Motion JPEG.
    Jpeg(Box<MotionJpeg>),
}

impl Decoder {
    /// Creates a decoder for images in `coding` that scales them by `fit`.
    pub(super) fn new(coding: Coding, stride: usize, fit: Fit) -> Self {
        if coding == Coding::MotionJpeg {
            return Self::Jpeg(Box::new(MotionJpeg::new(fit)));
        }
        let (columns, rows) = fit.offered();
        let scaled =
            (!fit.is_exact()).then(|| (Picture::black(columns, rows), AreaAverage::new(&fit, 1)));
        Self::Raw {
            coding,
            stride,
            scaled,
        }
    }

    /// Decodes the camera's bytes into `picture`, which has the wanted size.
    pub(super) fn decode(&mut self, bytes: &[u8], picture: &mut Picture) -> Result<(), String> {
        match self {
            Self::Jpeg(decoder) => decoder.decode(bytes, picture).map_err(|e| e.to_string()),
            Self::Raw {
                coding,
                stride,
                scaled: None,
            } => unpack(*coding, *stride, bytes, picture),
            Self::Raw {
                coding,
                stride,
                scaled: Some((whole, average)),
            } => {
                unpack(*coding, *stride, bytes, whole)?;
                average.average(&whole.pixels, whole.width, &mut picture.pixels);
                Ok(())
            }
        }
    }
}

/// Copies the grey values of the camera's pixels into `picture`, which has the camera's size.
fn unpack(
    coding: Coding,
    stride: usize,
    bytes: &[u8],
    picture: &mut Picture,
) -> Result<(), String> {
    let (width, height) = (picture.width, picture.height);
    let bytes_per_pixel = match coding {
        Coding::Gray => 1,
        Coding::Yuyv => 2,
        Coding::MotionJpeg => return Err("expected uncompressed pixels, got Motion JPEG".into()),
    };
    let row_bytes = width * bytes_per_pixel;
    let stride = stride.max(row_bytes);
    let expected = stride * height.saturating_sub(1) + row_bytes;
    if bytes.len() < expected {
        return Err(format!("expected {expected} bytes, got {}", bytes.len()));
    }
    let rows = picture.pixels.chunks_exact_mut(width.max(1));
    for (row, bytes) in rows.zip(bytes.chunks(stride)) {
        for (pixel, value) in row.iter_mut().zip(bytes.iter().step_by(bytes_per_pixel)) {
            *pixel = *value;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_padding_and_colours_are_skipped() {
        let mut picture = Picture::black(2, 2);
        let gray = [1, 2, 99, 3, 4];
        assert_eq!(unpack(Coding::Gray, 3, &gray, &mut picture), Ok(()));
        assert_eq!(picture.pixels, [1, 2, 3, 4]);
        let yuyv = [5, 99, 6, 99, 7, 99, 8, 99];
        assert_eq!(unpack(Coding::Yuyv, 4, &yuyv, &mut picture), Ok(()));
        assert_eq!(picture.pixels, [5, 6, 7, 8]);
        assert!(unpack(Coding::Gray, 3, &gray[..4], &mut picture).is_err());
        assert!(unpack(Coding::MotionJpeg, 0, &gray, &mut picture).is_err());
    }

    #[test]
    fn pixels_of_another_size_are_averaged() {
        let fit = Fit::new((4, 2), (2, 1)).expect("a fit");
        let mut picture = Picture::black(2, 1);
        let gray = [1, 3, 20, 20, 5, 7, 20, 24];
        let mut decoder = Decoder::new(Coding::Gray, 4, fit);
        assert_eq!(decoder.decode(&gray, &mut picture), Ok(()));
        assert_eq!(picture.pixels, [4, 21]);
        assert!(decoder.decode(&gray[..7], &mut picture).is_err());
    }
}
