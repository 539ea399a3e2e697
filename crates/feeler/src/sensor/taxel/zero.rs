//! Zero offsets of the taxels' columns.

use super::rezero::StillTime;
use super::{TaxelDrift, TaxelLayout};
use glam::DVec3;

/// Zero offsets of all taxels. Updates do not allocate.
#[derive(Debug, Clone)]
pub struct Zeros {
    /// Number of unloaded rows at the start of a sequence.
    rows: u32,
    /// Number of unloaded rows read in this sequence.
    taken: u32,
    drift: Option<TaxelDrift>,
    /// Detector of a time without contact and motion; `None` if the zero is measured only once.
    still: Option<StillTime>,
    zeros: Vec<Zero>,
    /// Time of the latest row, s.
    newest: Option<f64>,
    /// Time of the latest contact, s.
    touched: Option<f64>,
}

#[derive(Debug, Clone)]
struct Zero {
    /// Zero specified in the layout.
    given: DVec3,
    /// Number of valid unloaded rows so far.
    rows: u32,
    /// Mean of the valid unloaded rows, or `given`.
    taken: DVec3,
    /// Drift correction, in the unit of the columns.
    drift: DVec3,
    /// Maximum drift correction, in the unit of the columns.
    most: DVec3,
}

impl Zeros {
    /// Creates the zeros of `layout`, whose columns have `scales` counts per newton.
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
            still: (layout.rezero).map(|rule| StillTime::new(rule, layout.taxels.len())),
            zeros: zeros.collect(),
            newest: None,
            touched: None,
        }
    }

    /// Starts a new sequence, which begins without load.
    pub fn restart(&mut self) {
        (self.taken, self.newest, self.touched) = (0, None, None);
        if let Some(still) = &mut self.still {
            still.restart();
        }
        for zero in &mut self.zeros {
            (zero.rows, zero.taken, zero.drift) = (0, zero.given, DVec3::ZERO);
        }
    }

    /// Adds a row to the mean if it is one of the unloaded rows.
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

    /// Zero of a taxel; NaN if no unloaded row had a valid value.
    pub fn of(&self, taxel: usize) -> DVec3 {
        let zero = &self.zeros[taxel];
        if self.rows > 0 && zero.rows == 0 {
            return DVec3::NAN;
        }
        zero.taken + zero.drift
    }

    /// Returns `true` once all unloaded rows of this sequence have been processed.
    pub fn are_taken(&self) -> bool {
        self.taken >= self.rows
    }

    /// Updates the zeros with a row of `values` at time `stamp` (s): corrects drift and, if configured, measures the
    /// zero again. `scales` are the counts per newton of the columns. `longest` is the largest magnitude of the taxels'
    /// readings, N (or counts), or `None` if no reading is valid.
    pub fn follow(&mut self, stamp: f64, values: &[DVec3], scales: &[DVec3], longest: Option<f64>) {
        if !self.are_taken() {
            return;
        }
        if let Some(longest) = longest {
            self.rezero(stamp, values, scales, longest);
        }
        let interval = self.newest.replace(stamp).map(|newest| stamp - newest);
        let (Some(drift), Some(longest)) = (self.drift, longest) else {
            return;
        };
        if longest > drift.untouched {
            self.touched = Some(stamp);
        }
        // The magnitude also handles times that go backward.
        let settled = (self.touched).is_none_or(|touched| (stamp - touched).abs() > drift.settle);
        let Some(interval) = interval.filter(|&interval| settled && interval > 0.0) else {
            return;
        };
        // Limits the weight of a single row after a gap to about a tenth.
        let part = 1.0 - libm::exp(-(interval / drift.time_constant).min(0.1));
        let valid = self.zeros.iter_mut().zip(values);
        for (zero, value) in valid.filter(|(_, value)| !value.is_nan()) {
            let off = *value - zero.taken - zero.drift;
            zero.drift = (zero.drift + part * off).clamp(-zero.most, zero.most);
        }
    }

    /// Replaces the zero with the mean of a sufficiently long time without contact and motion.
    fn rezero(&mut self, stamp: f64, values: &[DVec3], scales: &[DVec3], longest: f64) {
        let Some(still) = &mut self.still else { return };
        if !still.add(stamp, values, scales, longest) {
            return;
        }
        for (taxel, zero) in self.zeros.iter_mut().enumerate() {
            if let Some(mean) = still.mean(taxel) {
                (zero.taken, zero.drift) = (mean, DVec3::ZERO);
                zero.rows = zero.rows.max(1);
            }
        }
        still.restart();
    }
}
