//! Rejection of uniform magnetic fields: the mean over all taxels is subtracted from each.
//!
//! A uniform field adds the same vector to all readings, in the axes of each chip. A force on one of n taxels
//! contributes 1/n of itself to the mean: it is measured reduced by 1/n, and all other taxels report -1/n of it.

use super::Axes;
use glam::{DVec2, DVec3};

/// Minimum number of valid taxels, so that a single one does not dominate the mean.
pub const FEWEST: usize = 3;

/// Mean of the valid `readings` of all taxels, in a common frame; NaN if fewer than [`FEWEST`] taxels are valid. A
/// reading contains the columns x, y and z of a taxel; NaN marks an invalid one. `turns` are the cosine and sine of
/// each taxel's rotation relative to the common frame.
pub fn mean(axes: &Axes, turns: &[DVec2], readings: impl Iterator<Item = DVec3>) -> DVec3 {
    let (mut sum, mut count) = (DVec3::ZERO, 0_usize);
    for (reading, turn) in readings.zip(turns).filter(|(r, _)| !r.is_nan()) {
        let own = axes.apply(reading);
        sum += turn.rotate(own.truncate()).extend(own.z);
        count += 1;
    }
    match count {
        FEWEST.. => sum / count as f64,
        _ => DVec3::NAN,
    }
}
