//! Bright spots of an image.

use glam::DVec2;
use std::f64::consts::SQRT_2;

/// A bright spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    /// Column and row, px.
    pub centre: DVec2,
    /// Scale of the maximum blob response, px: the spot's radius divided by the square root of two.
    pub sigma: f64,
    /// Blob response, gray levels.
    pub response: f64,
    /// Diameter of the disc with the same area as the spot, px; derived from the blob scale until measured.
    pub diameter: f64,
    /// Gray levels above the local background; the blob response until measured.
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

/// Spots found in an image.
#[derive(Debug, Clone)]
pub(super) struct FoundSpots {
    pub spots: Vec<Spot>,
    /// Centres of spots rejected because their position, size or contrast does not match the pattern.
    pub left_out: Vec<DVec2>,
    /// Centres of spots cut by the image border.
    pub cut: Vec<DVec2>,
    /// Noise of a single image, gray levels.
    pub noise: f64,
}
