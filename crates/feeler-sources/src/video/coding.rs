//! How a camera codes its pictures, and what is grey in them. No device is needed for it.

use crate::picture::decode_picture;
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
    pub(super) const ALL: [(Self, PixelFormat); 3] = [
        (Self::Gray, PixelFormat::from_fourcc(*b"GREY")),
        (Self::Yuyv, PixelFormat::YUYV),
        (Self::MotionJpeg, PixelFormat::MJPG),
    ];
}

/// Puts the camera's bytes into `picture`.
pub(super) fn unpack(
    coding: Coding,
    stride: usize,
    bytes: &[u8],
    picture: &mut Picture,
) -> Result<(), String> {
    let (width, height) = (picture.width, picture.height);
    let bytes_per_pixel = match coding {
        Coding::Gray => 1,
        Coding::Yuyv => 2,
        Coding::MotionJpeg => {
            let decoded = decode_picture(bytes).map_err(|e| e.to_string())?;
            if (decoded.width, decoded.height) != (width, height) {
                let (columns, rows) = (decoded.width, decoded.height);
                return Err(format!(
                    "{width}x{height} px expected, got {columns}x{rows} px"
                ));
            }
            *picture = decoded;
            return Ok(());
        }
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
}
