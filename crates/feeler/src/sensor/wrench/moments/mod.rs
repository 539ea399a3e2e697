//! Regression features: standardised growth and displacement of every element.
//!
//! Features are relative to each element's mean over the images of the calibration, so that no unloaded image is
//! needed; the intercept compensates for the difference:
//!
//! ```text
//! growth         G/G_0 / m - 1      m = mean of G/G_0 over the elements: the image's common gain
//! plain growth   G/G_0 - 1
//! displacement   u_x, u_y = c - c_0
//! ```
//!
//! The displacement field is also described by a few modes of deformation (`modes`); the modes and their products are
//! candidate features.
//!
//! A dimming lamp changes `m` but not the growth, in which a global gain cancels. Only plain growth is affected.

mod basis;
mod modes;
mod standard;

pub use basis::MomentBasis;
pub use standard::ElementStandard;

use crate::sensor::forces::sensing::ElementReading;
use crate::sensor::image::exposure::Exposure;
use crate::sensor::moments::kernel::ElementMoments;
use serde::{Deserialize, Serialize};

/// Number of features of one element: growth, plain growth, displacement along x and along y.
pub const PER_ELEMENT: usize = 4;

/// Minimum number of elements required to separate a common gain from the loads.
pub const MIN_FOR_GAIN: usize = 4;

/// Definition of an element's growth (relative change of its integrated gray value).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Growth {
    /// Growth is not used.
    Ignored,
    /// Relative to the common gain of the image, so that a dimming lamp has no effect.
    GainFree,
    /// Not corrected for the common gain: a dimming lamp affects it like a force.
    Plain,
}

/// Features used for the regression of a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Terms {
    /// Growth feature of each element.
    pub growth: Growth,
    /// `true` to use the displacement of each element.
    pub displacement: bool,
    /// `true` to also use the squares of these features.
    pub squares: bool,
    /// `true` to use the modes of the displacement field and the products of all pairs of modes.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub modes: bool,
}

impl Terms {
    /// Indices of the used features among the [`PER_ELEMENT`] of an element.
    fn kinds(self) -> impl Iterator<Item = usize> + Clone {
        let growth = match self.growth {
            Growth::Ignored => None,
            Growth::GainFree => Some(0),
            Growth::Plain => Some(1),
        };
        let displacement = if self.displacement { 2..4 } else { 0..0 };
        growth.into_iter().chain(displacement)
    }
}

/// Returns the moments of a reading; `None` if the element is dark or saturated.
pub fn usable(reading: &ElementReading) -> Option<ElementMoments> {
    let good = reading.exposure == Exposure::Good && reading.integrated_gray.is_finite();
    let centroid = reading
        .centroid
        .filter(|centroid| good && centroid.is_finite())?;
    (reading.integrated_gray > 0.0).then_some(ElementMoments {
        integrated_gray: reading.integrated_gray,
        centroid,
    })
}
