//! Whether loads can be what the pictures show.
//!
//! A calibration is fitted to whatever a table says. Where the table is wrong in an ordinary way (signs, axes, units, numbers of elements,
//! zeros), the fit may be as good as ever and the forces wrong in use. Part of that shows in the pictures, as the spot of an element
//! grows when it is pressed, and its centroid moves the way it is dragged:
//!
//! - [`check_magnitude`]: loads that no soft element bears, or that no picture shows;
//! - [`check_numbers`]: loads of one element that the pictures show on another;
//! - [`check_axes`], [`check_axes_of_recordings`]: forces whose signs or axes are not those of growth and displacement;
//! - [`check_unloaded`], [`check_offsets`]: recordings whose zeros differ;
//! - [`check_outliers`]: a single load that all others contradict.

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

use super::{loads::TakenPicture, moments::ElementMoments};
use glam::DVec3;

/// Names of the columns.
const COLUMNS: [&str; 3] = ["f_x", "f_y", "f_z"];

/// Range, N, of the largest force on a single element. Less is lost in the noise of pictures; under more, the few square millimetres of
/// silicone of an element are flat, at some 1 N/mm².
pub const ELEMENT_RANGE: [f64; 2] = [0.01, 20.0];
/// Like [`ELEMENT_RANGE`], but of a whole fingertip, whose contact is some square centimetres.
pub const FINGERTIP_RANGE: [f64; 2] = [0.05, 200.0];

/// Refuses `forces` (N) on `what` whose largest is outside of a `range`, as forces in another unit are.
///
/// # Errors
/// Names the largest, the range and the likely unit.
pub fn check_magnitude(
    what: &'static str,
    forces: impl Iterator<Item = DVec3>,
    range: [f64; 2],
) -> Result<(), LoadCheckError> {
    let largest = forces.map(DVec3::length).fold(0.0, f64::max);
    let [low, high] = range;
    let (unit, reason) = match largest {
        // Without any load, other checks say more.
        0.0 => return Ok(()),
        largest if largest > high => ("mN", "soft silicone bears about 1 N/mm²"),
        largest if largest < low => ("kN", "less is lost in the noise of pictures"),
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

/// Mean integrated gray value and centroid of an element without load; `None` if it is dark, or no picture is without load.
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

/// A recording's name; of pictures in the table's own folder, whose names are numbers, that folder.
fn named(recording: &str) -> String {
    if recording.is_empty() {
        ".".into()
    } else {
        recording.into()
    }
}

#[cfg(test)]
mod tests;
