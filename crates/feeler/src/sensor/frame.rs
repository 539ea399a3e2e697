//! One grey picture, with the time at which it was taken.

/// A grey 8-bit picture from a fingertip's camera, row by row from the top left. Its pixels are its own, or somebody
/// else's, as in `Picture<&[u8]>`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Picture<P = Vec<u8>> {
    /// Columns, px.
    pub width: usize,
    /// Rows, px.
    pub height: usize,
    /// Grey values, `width * height` of them, row-major; 0 is dark, 255 saturated.
    pub pixels: P,
}

impl Picture {
    /// A black picture of `width` by `height` px.
    pub fn black(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![0; width * height],
        }
    }
}

/// A picture and when it was taken: what a [`Camera`](super::camera::Camera) delivers.
///
/// A frame is allocated once and filled again and again, so that sensing allocates nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Counts the camera's exposures from 0; a gap is a dropped frame.
    pub sequence: u64,
    /// Time of exposure, s, on the clock of the camera (simulated time in a simulation).
    pub stamp: f64,
    /// What the camera saw.
    pub picture: Picture,
}

impl Frame {
    /// A black frame of `width` by `height` px, to be filled by a camera.
    pub fn black(width: usize, height: usize) -> Self {
        Self {
            sequence: 0,
            stamp: 0.0,
            picture: Picture::black(width, height),
        }
    }
}
