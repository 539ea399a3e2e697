//! How a camera codes its pictures, and what is grey in them. No device is needed for it.

use crate::fit::{AreaAverage, Fit};
use crate::motion_jpeg::MotionJpeg;
use feeler::sensor::frame::Picture;
use linuxvideo::format::PixelFormat;

/// How the camera codes its pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    Gray,
    Yuyv,
    MotionJpeg,
}

impl Coding {
    /// All of them, the first to be preferred.
    pub(super) const ALL: [Self; 3] = [Self::Gray, Self::Yuyv, Self::MotionJpeg];

    /// Its code in Video4Linux.
    pub(super) fn pixels(self) -> PixelFormat {
        match self {
            Self::Gray => PixelFormat::from_fourcc(*b"GREY"),
            Self::Yuyv => PixelFormat::YUYV,
            Self::MotionJpeg => PixelFormat::MJPG,
        }
    }
}

/// Makes grey pictures of the wanted size from the camera's bytes.
pub(super) enum Decoder {
    /// Pixels as they are, in rows `stride` bytes apart.
    Raw {
        coding: Coding,
        stride: usize,
        /// A picture of the camera's size, and how it is scaled; `None` if it already has the wanted size.
        scaled: Option<(Picture, AreaAverage)>,
    },
    /// Motion JPEG.
    Jpeg(Box<MotionJpeg>),
}

impl Decoder {
    /// Decodes pictures of `coding` as `fit` says.
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

    /// Puts the camera's bytes into `picture`, which has the wanted size.
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

/// Puts the grey of the camera's pixels into `picture`, which has the camera's size.
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
        Coding::MotionJpeg => return Err("pixels expected, got Motion JPEG".into()),
    };
    let row_bytes = width * bytes_per_pixel;
    let stride = stride.max(row_bytes);
    let expected = stride * height.saturating_sub(1) + row_bytes;
    if bytes.len() < expected {
        return Err(format!("{expected} bytes expected, got {}", bytes.len()));
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
    fn rows_are_taken_without_their_padding_and_colours() {
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
