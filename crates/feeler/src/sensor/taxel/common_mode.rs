//! Rejection of uniform magnetic fields.

use super::{Axes, TaxelLayout};
use glam::{DVec2, DVec3};

/// Minimum number of taxels with a value, for a mean that is not dominated by one of them.
pub const FEWEST: usize = 3;

/// Subtracts the mean over all taxels from each, in the unit of the columns.
///
/// A uniform field changes the readings of all chips by the same vector, expressed in the axes of each chip. The mean of
/// n taxels also contains the n-th part of a force on one of them, so forces on single taxels are reduced by that part
/// and appear on all others with the opposite sign.
#[derive(Debug, Clone)]
pub struct CommonMode {
    axes: Axes,
    /// Cosine and sine of each taxel's rotation.
    turns: Vec<DVec2>,
}

impl CommonMode {
    /// Creates the rejection for `layout` with these rotations of its taxels, or returns `None` if it is not enabled.
    pub fn of(layout: &TaxelLayout, turns: &[DVec2]) -> Option<Self> {
        layout.common_mode.then(|| Self {
            axes: layout.axes,
            turns: turns.to_vec(),
        })
    }

    /// Mean of `readings` in the columns x, y and z of each taxel, in the common frame of all taxels; NaN if fewer than
    /// three are valid. Readings that are NaN are ignored.
    pub fn mean(&self, readings: impl Iterator<Item = DVec3>) -> DVec3 {
        let (mut sum, mut count) = (DVec3::ZERO, 0_usize);
        let valid = readings.zip(&self.turns).filter(|(r, _)| !r.is_nan());
        for (reading, turn) in valid {
            let own = self.axes.apply(reading);
            sum += turn.rotate(own.truncate()).extend(own.z);
            count += 1;
        }
        match count {
            FEWEST.. => sum / count as f64,
            _ => DVec3::NAN,
        }
    }

    /// Converts a `mean` to the columns x, y and z of a taxel.
    pub fn in_columns(&self, mean: DVec3, taxel: usize) -> DVec3 {
        let turn = self.turns[taxel];
        let back = DVec2::new(turn.x, -turn.y);
        self.axes.undo(back.rotate(mean.truncate()).extend(mean.z))
    }
}
