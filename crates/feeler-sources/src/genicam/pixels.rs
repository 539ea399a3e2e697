//! Grey pixel formats of GenICam cameras. Independent of hardware.

use feeler::sensor::image::Picture;

/// Pixel format of a camera's images. Names and codes are those of the Pixel Format Naming Convention.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pixels {
    Mono8,
    Mono10,
    Mono12,
    Mono16,
}

impl Pixels {
    /// All formats, in order of preference. Other formats are reduced to 8 bits, so they are used only if a camera has
    /// no `Mono8`.
    pub(super) const ALL: [Self; 4] = [Self::Mono8, Self::Mono10, Self::Mono12, Self::Mono16];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Mono8 => "Mono8",
            Self::Mono10 => "Mono10",
            Self::Mono12 => "Mono12",
            Self::Mono16 => "Mono16",
        }
    }

    pub(super) fn code(self) -> u32 {
        match self {
            Self::Mono8 => 0x0108_0001,
            Self::Mono10 => 0x0110_0003,
            Self::Mono12 => 0x0110_0005,
            Self::Mono16 => 0x0110_0007,
        }
    }

    /// Number of bits to drop from two-byte pixels; `None` for one-byte pixels.
    fn shift(self) -> Option<u32> {
        match self {
            Self::Mono8 => None,
            Self::Mono10 => Some(2),
            Self::Mono12 => Some(4),
            Self::Mono16 => Some(8),
        }
    }

    /// Converts the camera's bytes to `picture`. Bytes after the image (chunk data) are ignored.
    pub(super) fn unpack(self, bytes: &[u8], picture: &mut Picture) -> Result<(), String> {
        let pixels = &mut picture.pixels;
        let expected = pixels.len() * if self.shift().is_some() { 2 } else { 1 };
        let actual = bytes.len();
        let bytes = bytes
            .get(..expected)
            .ok_or_else(|| format!("expected {expected} bytes, got {actual}"))?;
        match self.shift() {
            None => pixels.copy_from_slice(bytes),
            Some(shift) => {
                for (pixel, pair) in pixels.iter_mut().zip(bytes.chunks_exact(2)) {
                    let value = u16::from_le_bytes([pair[0], pair[1]]) >> shift;
                    *pixel = value.min(255) as u8;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_pixel_formats_are_scaled_to_eight_bits() {
        let mut picture = Picture::black(2, 2);
        let gray = [1, 2, 3, 4, 99];
        assert_eq!(Pixels::Mono8.unpack(&gray, &mut picture), Ok(()));
        assert_eq!(picture.pixels, [1, 2, 3, 4]);
        for (pixels, full) in [
            (Pixels::Mono10, 0x03ff_u16),
            (Pixels::Mono12, 0x0fff),
            (Pixels::Mono16, 0xffff),
        ] {
            let half = full / 2;
            let bytes: Vec<u8> = [0, half, full, 0]
                .iter()
                .flat_map(|v: &u16| v.to_le_bytes())
                .collect();
            assert_eq!(pixels.unpack(&bytes, &mut picture), Ok(()));
            assert_eq!(picture.pixels, [0, 127, 255, 0], "{pixels:?}");
            assert!(pixels.unpack(&bytes[..7], &mut picture).is_err());
        }
        // Bits that a camera must leave zero do not overflow.
        assert_eq!(Pixels::Mono10.unpack(&[0xff; 8], &mut picture), Ok(()));
        assert_eq!(picture.pixels, [255; 4]);
    }
}
