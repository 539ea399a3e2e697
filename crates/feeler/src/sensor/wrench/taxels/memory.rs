//! Low-pass filters of taxel readings, from which hysteresis and creep are estimated.

use glam::DVec3;

/// Time constants of the filters, s.
pub const TIME_CONSTANTS: [f64; 5] = [0.3, 1.0, 3.0, 10.0, 30.0];

/// Readings of all taxels at one time, and their low-pass filters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TaxelInput {
    /// Reading of each taxel, N or counts; NaN if missing.
    pub values: Vec<DVec3>,
    /// Reading of each taxel, low-pass filtered with each of [`TIME_CONSTANTS`].
    pub filtered: Vec<[DVec3; TIME_CONSTANTS.len()]>,
}

/// First-order low-pass filters of the readings of a taxel array. The initial state is without load.
#[derive(Debug, Clone)]
pub struct Memory {
    filtered: Vec<[DVec3; TIME_CONSTANTS.len()]>,
    /// Time of the latest row, s.
    last_stamp: Option<f64>,
}

impl Memory {
    /// Creates the filters of `taxels` taxels.
    pub fn new(taxels: usize) -> Self {
        Self {
            filtered: vec![[DVec3::ZERO; TIME_CONSTANTS.len()]; taxels],
            last_stamp: None,
        }
    }

    /// Starts a new sequence, which begins without load.
    pub fn restart(&mut self) {
        self.last_stamp = None;
        self.filtered.fill([DVec3::ZERO; TIME_CONSTANTS.len()]);
    }

    /// Updates the filters with the readings `values` at `stamp` (s), and writes both to `input`. A missing reading
    /// leaves its filters unchanged, as do all readings if time does not advance. Does not allocate if `input` has the
    /// same number of taxels.
    pub fn update(&mut self, stamp: f64, values: &[DVec3], input: &mut TaxelInput) {
        let last_stamp = self.last_stamp.replace(stamp);
        let interval = last_stamp.map_or(0.0, |last_stamp| stamp - last_stamp);
        for (index, constant) in TIME_CONSTANTS.iter().enumerate() {
            let part = 1.0 - libm::exp(-interval.max(0.0) / constant);
            let valid = self.filtered.iter_mut().zip(values);
            for (filtered, value) in valid.filter(|(_, value)| !value.is_nan()) {
                filtered[index] += part * (*value - filtered[index]);
            }
        }
        input.values.clear();
        input.values.extend_from_slice(values);
        input.filtered.clone_from(&self.filtered);
    }
}
