//! Grayscale images with their exposure times.

/// An 8-bit grayscale image from a fingertip's camera, row by row from the top left. The pixels are owned, or
/// borrowed as in `Picture<&[u8]>`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Picture<P = Vec<u8>> {
    /// Width, px.
    pub width: usize,
    /// Height, px.
    pub height: usize,
    /// Gray values, row-major, `width * height` in number; 0 is dark, 255 saturated.
    pub pixels: P,
}

impl Picture {
    /// Creates a black image of `width` by `height` px.
    pub fn black(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![0; width * height],
        }
    }
}

/// An image with its exposure time, as delivered by a [`Camera`](super::camera::Camera).
///
/// Frames are allocated once and reused, so that sensing does not allocate.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Sequence number of the exposure, from 0; a gap indicates dropped frames.
    pub sequence: u64,
    /// Time of exposure by the camera's clock, s (simulated time in a simulation).
    pub stamp: f64,
    /// The image.
    pub picture: Picture,
}

impl Frame {
    /// Creates a black frame of `width` by `height` px, to be filled by a camera.
    pub fn black(width: usize, height: usize) -> Self {
        Self {
            sequence: 0,
            stamp: 0.0,
            picture: Picture::black(width, height),
        }
    }
}
