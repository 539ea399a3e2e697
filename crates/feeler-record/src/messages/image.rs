//! Camera images: uncompressed, as used by the control loop, and as ROS 2's `sensor_msgs/CompressedImage`, which every
//! viewer of recordings displays.

use super::channels::Stamped;
use crate::error::RecordError;
use crate::ros::{CompressedImage, Header, Time};
use crate::wire::{Message, WireError, cdr};
use ::image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use ::image::{ColorType, ExtendedColorType, ImageDecoder, ImageEncoder};
use feeler::sensor::image::{Frame, Picture};
use serde::{Deserialize, Serialize};
use std::io::Cursor;

/// Format of recorded images: 8-bit grey, lossless.
const PNG: &str = "png";

/// Maximum number of pixels of an image that is read. Guards against damaged files.
const MAX_PIXELS: u64 = 1 << 26;

/// A grey image to be recorded, row by row from the top left. The recorder's thread converts it to a
/// [`CompressedImage`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image {
    /// Time and camera. The [`Tactile`](crate::Tactile) frame computed from the image has the stamp in full precision.
    pub header: Header,
    /// Height (px).
    pub height: u32,
    /// Width (px).
    pub width: u32,
    /// The pixels. Serialized as one block: element by element, an image would take a hundred times as long.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

/// Has the schema of [`CompressedImage`], as which it is recorded.
impl Message for Image {
    const SCHEMA_NAME: &'static str = CompressedImage::SCHEMA_NAME;
    const SCHEMA: &'static str = CompressedImage::SCHEMA;
}

impl Stamped for Image {
    fn stamp(&self) -> f64 {
        self.header.seconds()
    }
}

impl Image {
    /// Creates an empty image of the camera in `finger`'s fingertip.
    pub fn of_finger(finger: usize) -> Self {
        Self {
            header: Header::of(format!("finger_{finger}_camera")),
            height: 0,
            width: 0,
            data: Vec::new(),
        }
    }

    /// Copies `frame`. Allocates only if it is larger than all frames before.
    ///
    /// # Errors
    /// If its stamp is not a valid time, or its size does not fit the message.
    pub fn fill(&mut self, frame: &Frame) -> Result<(), RecordError> {
        let stamp = Time::of(frame.stamp);
        self.header.stamp = stamp.ok_or_else(|| RecordError::Stamp {
            topic: self.header.frame_id.clone(),
            stamp: frame.stamp,
        })?;
        let side = |pixels: usize| {
            u32::try_from(pixels).map_err(|e| WireError::Encode {
                schema: Self::SCHEMA_NAME,
                reason: format!("{pixels} px: {e}"),
            })
        };
        self.height = side(frame.picture.height)?;
        self.width = side(frame.picture.width)?;
        self.data.clear();
        self.data.extend_from_slice(&frame.picture.pixels);
        Ok(())
    }

    /// Compresses the image to its recorded form.
    ///
    /// # Errors
    /// If it has no pixels, or `data` does not match the size.
    pub fn compressed(self) -> Result<CompressedImage, WireError> {
        let mut data = Vec::with_capacity(self.data.len() / 2);
        // Differences between pixels are noise: the fastest compression saves as much as the slowest.
        let encoder =
            PngEncoder::new_with_quality(&mut data, CompressionType::Fast, FilterType::Sub);
        let (width, height) = (self.width, self.height);
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels != self.data.len() as u64 {
            return Err(WireError::Encode {
                schema: Self::SCHEMA_NAME,
                reason: format!(
                    "expected {width}x{height} px, got {} bytes",
                    self.data.len()
                ),
            });
        }
        let written = encoder.write_image(&self.data, width, height, ExtendedColorType::L8);
        written.map_err(|e| WireError::Encode {
            schema: Self::SCHEMA_NAME,
            reason: e.to_string(),
        })?;
        Ok(CompressedImage {
            header: self.header,
            format: PNG.into(),
            data,
        })
    }
}

/// Converts an encoded [`Image`] to the encoded [`CompressedImage`] that is recorded.
pub(crate) fn compress(bytes: &[u8]) -> Result<Vec<u8>, RecordError> {
    let image: Image = cdr::decode(bytes)?;
    let mut compressed = Vec::new();
    cdr::encode(&image.compressed()?, &mut compressed)?;
    Ok(compressed)
}

/// Width and height of a recorded image (px).
///
/// # Errors
/// If it is not an 8-bit grey image. Returns a description.
pub(crate) fn size(image: &CompressedImage) -> Result<(u32, u32), String> {
    decoder(image).map(|decoder| decoder.dimensions())
}

/// Decompresses a recorded image.
///
/// # Errors
/// If it is not an 8-bit grey image, or is damaged. Returns a description.
pub(crate) fn picture(image: &CompressedImage) -> Result<Picture, String> {
    let decoder = decoder(image)?;
    let (width, height) = decoder.dimensions();
    let mut pixels = vec![0; width as usize * height as usize];
    decoder.read_image(&mut pixels).map_err(|e| e.to_string())?;
    Ok(Picture {
        width: width as usize,
        height: height as usize,
        pixels,
    })
}

fn decoder(image: &CompressedImage) -> Result<PngDecoder<Cursor<&[u8]>>, String> {
    if image.format != PNG {
        return Err(format!("expected {PNG}, got {:?}", image.format));
    }
    let decoder = PngDecoder::new(Cursor::new(image.data.as_slice()));
    let decoder = decoder.map_err(|e| e.to_string())?;
    let (width, height) = decoder.dimensions();
    if decoder.color_type() != ColorType::L8 {
        let found = decoder.color_type();
        return Err(format!("expected 8-bit grey pixels, got {found:?}"));
    }
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(format!(
            "expected at most {MAX_PIXELS} px, got {width}x{height}"
        ));
    }
    Ok(decoder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::channels::nanoseconds;

    fn frame() -> Frame {
        let mut frame = Frame::black(3, 2);
        frame.stamp = 12.345_678_901_2;
        frame.picture.pixels = vec![0, 1, 127, 128, 254, 255];
        frame
    }

    fn filled() -> Image {
        let mut image = Image::of_finger(1);
        image.fill(&frame()).unwrap();
        image
    }

    #[test]
    fn an_image_reads_back_as_it_was_written() {
        let mut bytes = Vec::new();
        cdr::encode(&filled(), &mut bytes).unwrap();
        let bytes = compress(&bytes).unwrap();
        let again: CompressedImage = cdr::decode(&bytes).unwrap();
        let (sec, nanosec) = (12, 345_678_901);
        assert_eq!(again.header.stamp, Time { sec, nanosec });
        assert_eq!(
            nanoseconds(again.header.seconds()),
            nanoseconds(frame().stamp)
        );
        assert_eq!(size(&again), Ok((3, 2)));
        assert_eq!(picture(&again), Ok(frame().picture));
        // It is rejected if truncated anywhere.
        for length in 0..bytes.len() {
            let image = cdr::decode::<CompressedImage>(&bytes[..length]);
            assert!(image.is_err(), "{length} bytes");
        }
        for length in 0..again.data.len() {
            let mut cut = again.clone();
            cut.data.truncate(length);
            // Checksum and end of the file do not affect the pixels.
            let pixels = picture(&cut);
            assert!(
                pixels.is_err() || pixels == Ok(frame().picture),
                "{length} bytes"
            );
        }
    }

    #[test]
    fn only_grey_images_are_accepted() {
        let mut coloured = Vec::new();
        let encoder = PngEncoder::new(&mut coloured);
        let written = encoder.write_image(&[0; 3], 1, 1, ExtendedColorType::Rgb8);
        written.unwrap();
        for (format, data) in [("jpeg", Vec::new()), (PNG, vec![0; 100]), (PNG, coloured)] {
            let image = CompressedImage {
                format: format.into(),
                data,
                ..CompressedImage::default()
            };
            picture(&image).unwrap_err();
            size(&image).unwrap_err();
        }
        for (width, data) in [(2, vec![0; 6]), (0, Vec::new())] {
            let image = Image {
                width,
                data,
                ..filled()
            };
            let reason = image.compressed().unwrap_err().to_string();
            assert!(reason.contains("expected"), "{reason}");
        }
        let mut image = filled();
        for stamp in [f64::NAN, -1.0, 1e10] {
            let mut frame = frame();
            frame.stamp = stamp;
            assert!(matches!(image.fill(&frame), Err(RecordError::Stamp { .. })));
        }
    }
}
