//! Bright spots of an image.

use glam::DVec2;
use std::f64::consts::SQRT_2;

/// A bright spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    /// Column and row, px.
    pub centre: DVec2,
    /// Scale of the maximum blob response, px: the spot's radius over the square root of two.
    pub sigma: f64,
    /// Blob response, gray levels.
    pub response: f64,
    /// Diameter of the disc that has the spot's area, px; the diameter from the blob scale until it is measured.
    pub diameter: f64,
    /// Gray levels above the local background; the blob response until it is measured.
    pub contrast: f64,
    /// `true` if the image border cuts the spot.
    pub cut: bool,
}

impl Spot {
    /// Diameter of the disc whose blob response peaks at scale `sigma`, px.
    pub fn scale(&self) -> f64 {
        2.0 * SQRT_2 * self.sigma
    }

    /// Converts from an image binned by `factor` to the original image.
    pub fn enlarged(self, factor: usize) -> Self {
        let factor = factor as f64;
        Self {
            centre: (self.centre + 0.5) * factor - 0.5,
            sigma: self.sigma * factor,
            diameter: self.diameter * factor,
            ..self
        }
    }
}

/// The spots of an image.
#[derive(Debug, Clone)]
pub(super) struct FoundSpots {
    pub spots: Vec<Spot>,
    /// Spots whose place, size or contrast is not that of the pattern.
    pub left_out: Vec<DVec2>,
    /// Spots that the image border cuts.
    pub cut: Vec<DVec2>,
    /// Noise of a single image, gray levels.
    pub noise: f64,
}
