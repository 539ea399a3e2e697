//! Low-pass filters of taxel readings, from which hysteresis and creep are estimated.

use glam::DVec3;

/// Time constants of the filters, s.
pub const TIME_CONSTANTS: [f64; 5] = [0.3, 1.0, 3.0, 10.0, 30.0];

/// Interval between rows above which the history is unknown, s. The skin is then assumed to have settled.
const GAP: f64 = 1.0;

/// Readings of all taxels at one time, with their filters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TaxelInput {
    /// Reading of each taxel, N or counts; NaN if missing.
    pub values: Vec<DVec3>,
    /// Reading of each taxel, filtered with each of [`TIME_CONSTANTS`].
    pub slow: Vec<[DVec3; TIME_CONSTANTS.len()]>,
}

/// First-order low-pass filters of the readings of a taxel array. Starts without load.
#[derive(Debug, Clone)]
pub struct Memory {
    slow: Vec<[DVec3; TIME_CONSTANTS.len()]>,
    /// Time of the latest row, s.
    newest: Option<f64>,
}

impl Memory {
    /// Creates the filters of `taxels` taxels.
    pub fn new(taxels: usize) -> Self {
        Self {
            slow: vec![[DVec3::ZERO; TIME_CONSTANTS.len()]; taxels],
            newest: None,
        }
    }

    /// Starts a sequence without load.
    pub fn restart(&mut self) {
        self.newest = None;
        self.slow.fill([DVec3::ZERO; TIME_CONSTANTS.len()]);
    }

    /// Updates the filters with the readings `values` at `stamp` (s), and writes both to `input`. A missing reading
    /// leaves its filters unchanged, as do all readings if time does not advance. After a gap of more than 1 s, filters equal the
    /// readings. Does not allocate if `input` has as
    /// many taxels.
    pub fn take(&mut self, stamp: f64, values: &[DVec3], input: &mut TaxelInput) {
        let newest = self.newest.replace(stamp);
        let interval = newest.map_or(0.0, |newest| stamp - newest);
        for (constant, place) in TIME_CONSTANTS.iter().zip(0..) {
            let part = match interval > GAP {
                true => 1.0,
                false => 1.0 - libm::exp(-interval.max(0.0) / constant),
            };
            let valid = self.slow.iter_mut().zip(values);
            for (slow, value) in valid.filter(|(_, value)| !value.is_nan()) {
                slow[place] += part * (*value - slow[place]);
            }
        }
        input.values.clear();
        input.values.extend_from_slice(values);
        input.slow.clone_from(&self.slow);
    }
}
