//! Plausibility checks of loads against the images.
//!
//! A calibration fits any table. If signs, axes, units, element numbers or zeros in the table are wrong, the fit may
//! still be good, but the forces will be wrong in use. Some of these mistakes show in the images, because an element's
//! spot grows when it is pressed and its centroid moves in the direction of shear:
//!
//! - [`check_magnitude`]: loads too large for a soft element or too small to show in an image;
//! - [`check_numbers`]: loads assigned to one element although the images show them on another;
//! - [`check_axes`], [`check_axes_of_recordings`]: forces whose signs or axes contradict growth and displacement;
//! - [`check_unloaded`], [`check_offsets`]: recordings with different zeros;
//! - [`check_outliers`]: a single load that contradicts all others.

mod axes;
mod error;
mod numbers;
mod outliers;
mod zeros;

pub use axes::{check_axes, check_axes_of_recordings};
pub use error::LoadCheckError;
pub use numbers::check_numbers;
pub use outliers::check_outliers;
pub use zeros::{check_offsets, check_unloaded};

use super::loads::CapturedImage;
use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec3;

/// Names of the force columns.
const COLUMNS: [&str; 3] = ["f_x", "f_y", "f_z"];

/// Rejects forces (N) if the largest is outside `range`, which indicates another unit. `what` names the loaded object.
///
/// # Errors
/// Returns [`LoadCheckError::Magnitude`] with the largest force, the range and the likely unit.
pub fn check_magnitude(
    what: &'static str,
    forces: impl Iterator<Item = DVec3>,
    range: [f64; 2],
) -> Result<(), LoadCheckError> {
    let largest = forces.map(DVec3::length).fold(0.0, f64::max);
    let [low, high] = range;
    let (unit, reason) = match largest {
        // Without any load, other checks report more useful errors.
        0.0 => return Ok(()),
        largest if largest > high => ("mN", "soft silicone bears about 1 N/mm²"),
        largest if largest < low => ("kN", "smaller loads are lost in image noise"),
        _ => return Ok(()),
    };
    Err(LoadCheckError::Magnitude {
        what,
        largest: to_three_digits(largest),
        low,
        high,
        reason,
        unit,
    })
}

fn to_three_digits(number: f64) -> f64 {
    format!("{number:.2e}").parse().unwrap_or(number)
}

/// Mean moments of an unloaded element; `None` if it is dark or there is no unloaded image.
fn unloaded_mean<'a>(unloaded: impl Iterator<Item = &'a ElementMoments>) -> Option<ElementMoments> {
    let mut sum = ElementMoments::default();
    let mut count = 0.0;
    for moments in unloaded {
        sum.integrated_gray += moments.integrated_gray;
        sum.centroid += moments.centroid;
        count += 1.0;
    }
    let mean = ElementMoments {
        integrated_gray: sum.integrated_gray / count,
        centroid: sum.centroid / count,
    };
    let is_lit =
        mean.integrated_gray > 0.0 && mean.integrated_gray.is_finite() && mean.centroid.is_finite();
    is_lit.then_some(mean)
}

/// Returns the name of a recording for messages: "." for numbered images in the table's own folder.
fn named(recording: &str) -> String {
    if recording.is_empty() {
        ".".into()
    } else {
        recording.into()
    }
}

#[cfg(test)]
mod tests;
