//! Converts the values of a table row to forces.

use super::zero::Zeros;
use super::{Axes, TaxelError, TaxelLayout, common_mode};
use crate::math::direction_at;
use crate::sensor::forces::reading::NO_FORCE;
use glam::{DVec2, DVec3};

/// Converts the values in a taxel array's columns to forces. Allocates only during construction.
#[derive(Debug, Clone)]
pub struct TaxelChain {
    axes: Axes,
    /// Counts per newton in the columns x, y, z of each taxel; 1 if the columns are in newtons or forces are in counts.
    scales: Vec<DVec3>,
    /// Cosine and sine of the rotation of each taxel about its normal.
    turns: Vec<DVec2>,
    zeros: Zeros,
    /// `true` if the mean over all taxels is subtracted.
    common_mode: bool,
}

impl TaxelChain {
    /// Creates a chain for `layout`.
    ///
    /// # Errors
    /// Returns [`TaxelError::Values`] if values of the layout are out of range.
    pub fn new(layout: &TaxelLayout) -> Result<Self, TaxelError> {
        layout.check()?;
        let scales: Vec<_> = (layout.taxels.iter())
            .map(|taxel| layout.scale(taxel).map_or(DVec3::ONE, DVec3::from_array))
            .collect();
        let turns = layout.taxels.iter().map(|t| t.turn_deg.to_radians());
        let turns: Vec<_> = turns.map(direction_at).collect();
        Ok(Self {
            axes: layout.axes,
            common_mode: layout.common_mode,
            turns,
            zeros: Zeros::new(layout, &scales),
            scales,
        })
    }

    /// Number of taxels.
    pub fn element_count(&self) -> usize {
        self.turns.len()
    }

    /// Starts a new sequence, in which the zeros are measured again.
    pub fn restart(&mut self) {
        self.zeros.restart();
    }

    /// Computes the forces at `stamp` (s) from the `values` in the columns x, y, z of each taxel, NaN if missing.
    ///
    /// Forces are in each element's frame `E_i`, in N as in a
    /// [`TactileFrame`](crate::sensor::forces::reading::TactileFrame), or in counts ([`TaxelLayout::force_unit`]). The
    /// force of a taxel without a value or without a zero is [`NO_FORCE`]. Neither allocates nor panics.
    pub fn sense(&mut self, stamp: f64, values: &[DVec3], forces: &mut [DVec3]) {
        self.zeros.take(values);
        let off_zero = values.iter().enumerate();
        let off_zero = off_zero.map(|(index, &value)| value - self.zeros.of(index));
        let mean = (self.common_mode).then(|| common_mode::mean(&self.axes, &self.turns, off_zero));
        let mut longest = None;
        let taxels = self.scales.iter().zip(&self.turns).zip(values);
        for ((index, ((&scale, &turn), &value)), force) in taxels.enumerate().zip(forces) {
            let mut reading = value - self.zeros.of(index);
            if let Some(mean) = mean {
                reading -= self.axes.in_columns(turn, mean);
            }
            let reading = self.axes.apply(reading / scale);
            if reading.is_nan() {
                *force = NO_FORCE;
                continue;
            }
            longest = Some(reading.length().max(longest.unwrap_or(0.0)));
            *force = turn.rotate(reading.truncate()).extend(reading.z);
        }
        self.zeros.follow(stamp, values, &self.scales, longest);
    }

    /// Indices of taxels without a zero after the unloaded rows.
    pub(super) fn without_zero(&self) -> impl Iterator<Item = usize> + '_ {
        let all = 0..self.element_count();
        all.filter(|&taxel| self.zeros.of(taxel).is_nan())
    }

    /// Returns `true` once all unloaded rows have been processed. Before that, forces are relative to the mean of the
    /// rows so far.
    pub fn has_zeros(&self) -> bool {
        self.zeros.are_taken()
    }
}
