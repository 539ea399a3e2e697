//! What a taxel's columns hold without load.

use super::{TaxelDrift, TaxelLayout};
use glam::DVec3;

/// The zeros of all taxels. Following them allocates nothing.
#[derive(Debug, Clone)]
pub struct Zeros {
    /// Rows without load at the beginning of a sequence.
    rows: u32,
    /// Rows of this sequence that were taken for it.
    taken: u32,
    drift: Option<TaxelDrift>,
    zeros: Vec<Zero>,
    /// Stamp of the newest row, s.
    newest: Option<f64>,
    /// When a taxel was touched last, s.
    touched: Option<f64>,
}

#[derive(Debug, Clone)]
struct Zero {
    /// As the layout says.
    given: DVec3,
    /// Valid rows that were taken.
    rows: u32,
    /// Their mean, or what was given.
    taken: DVec3,
    /// What drift has added, in the columns.
    drift: DVec3,
    /// Largest drift, in the columns.
    most: DVec3,
}

impl Zeros {
    /// Those of `layout`, whose columns have `scales` counts per newton.
    pub fn new(layout: &TaxelLayout, scales: &[DVec3]) -> Self {
        let most = layout.drift.map_or(0.0, |drift| drift.most);
        let zeros = layout.taxels.iter().zip(scales).map(|(taxel, &scale)| {
            let given = DVec3::from_array(taxel.zero.unwrap_or_default());
            Zero {
                given,
                rows: 0,
                taken: given,
                drift: DVec3::ZERO,
                most: most * scale,
            }
        });
        Self {
            rows: layout.zero.rows,
            taken: 0,
            drift: layout.drift,
            zeros: zeros.collect(),
            newest: None,
            touched: None,
        }
    }

    /// Begins a sequence, without load.
    pub fn restart(&mut self) {
        (self.taken, self.newest, self.touched) = (0, None, None);
        for zero in &mut self.zeros {
            (zero.rows, zero.taken, zero.drift) = (0, zero.given, DVec3::ZERO);
        }
    }

    /// Takes a row: one of those without load, at the beginning.
    pub fn take(&mut self, values: &[DVec3]) {
        if self.are_taken() {
            return;
        }
        self.taken += 1;
        let valid = self.zeros.iter_mut().zip(values);
        for (zero, value) in valid.filter(|(_, value)| !value.is_nan()) {
            zero.rows += 1;
            if zero.rows == 1 {
                zero.taken = *value;
            } else {
                zero.taken += (*value - zero.taken) / f64::from(zero.rows);
            }
        }
    }

    /// The zero of a taxel; not a number where no row without load had a valid value.
    pub fn of(&self, taxel: usize) -> DVec3 {
        let zero = &self.zeros[taxel];
        if self.rows > 0 && zero.rows == 0 {
            return DVec3::NAN;
        }
        zero.taken + zero.drift
    }

    /// Whether the rows without load of this sequence are over.
    pub fn are_taken(&self) -> bool {
        self.taken >= self.rows
    }

    /// Follows drift to the `values` of a row of time `stamp`, s, in which the reading of no taxel was longer than
    /// `longest`, N (counts); of none that is not a number, where there is any that is.
    pub fn follow(&mut self, stamp: f64, values: &[DVec3], longest: Option<f64>) {
        if !self.are_taken() {
            return;
        }
        let interval = self.newest.replace(stamp).map(|newest| stamp - newest);
        let (Some(drift), Some(longest)) = (self.drift, longest) else {
            return;
        };
        if longest > drift.untouched {
            self.touched = Some(stamp);
        }
        // Also where the time goes back, nothing is touched that was not.
        let settled = (self.touched).is_none_or(|touched| (stamp - touched).abs() > drift.settle);
        let Some(interval) = interval.filter(|&interval| settled && interval > 0.0) else {
            return;
        };
        // No single row after a gap counts for more than a tenth.
        let part = 1.0 - (-(interval / drift.time_constant).min(0.1)).exp();
        let valid = self.zeros.iter_mut().zip(values);
        for (zero, value) in valid.filter(|(_, value)| !value.is_nan()) {
            let off = *value - zero.taken - zero.drift;
            zero.drift = (zero.drift + part * off).clamp(-zero.most, zero.most);
        }
    }
}
