//! Moments of an element relative to its unloaded state, the inputs of a calibration.

use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec2;

/// An element's moments relative to the unloaded ones.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RelativeMoments {
    /// Relative growth of the integrated gray value, `G / G_0 - 1`.
    pub growth: f64,
    /// Displacement of the centroid, `c - c_0`, m (or px), in x, y of `E_i`.
    pub displacement: DVec2,
}

impl RelativeMoments {
    /// Computes `moments` relative to the unloaded integrated gray value and centroid.
    pub fn relative(
        moments: &ElementMoments,
        unloaded_gray: f64,
        unloaded_centroid: DVec2,
    ) -> Self {
        Self {
            growth: moments.integrated_gray / unloaded_gray - 1.0,
            displacement: moments.centroid - unloaded_centroid,
        }
    }

    /// Returns growth, displacement along x and displacement along y.
    pub(in crate::sensor) fn components(self) -> [f64; 3] {
        [self.growth, self.displacement.x, self.displacement.y]
    }
}
