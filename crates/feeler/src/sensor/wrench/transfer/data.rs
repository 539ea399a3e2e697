//! Samples of another copy of a sensor, grouped by press.

use crate::sensor::wrench::WrenchAxis;
use crate::sensor::wrench::basis::Basis;
use crate::sensor::wrench::blocks::{Fold, by_recording};
use crate::sensor::wrench::choice::Target;
use crate::sensor::wrench::error::WrenchError;
use crate::sensor::wrench::learn::{can_be_learned, target};
use crate::sensor::wrench::presses::presses;
use crate::sensor::wrench::sample::{SampleOf, recording_of};

/// Minimum number of presses: one to hold out, and two for choosing the penalty.
const MIN_PRESSES: usize = 3;

/// Samples of another copy of a sensor, grouped by press.
pub(super) struct PressData<'a, B: Basis> {
    pub samples: Vec<&'a SampleOf<B>>,
    /// Index of the press of each sample: the latest one that has started, or the first press of the recording.
    pub press_of: Vec<usize>,
    /// Number of presses.
    pub presses: usize,
}

impl<'a, B: Basis> PressData<'a, B> {
    pub fn new(samples: Vec<&'a SampleOf<B>>) -> Result<Self, WrenchError> {
        let presses = presses(&samples);
        if presses.len() < MIN_PRESSES {
            return Err(WrenchError::TooFewPresses {
                expected: MIN_PRESSES,
                actual: presses.len(),
            });
        }
        Ok(Self {
            press_of: press_of(&presses, &recording_of(&samples)),
            presses: presses.len(),
            samples,
        })
    }

    /// Measured values of a component, except those of the press `held`; `None` if there are too few.
    pub fn target(&self, axis: WrenchAxis, held: Option<usize>) -> Option<Target> {
        let mut target = target(&self.samples, axis);
        let rows = target.rows.iter().zip(&target.measured);
        let rows = rows.filter(|(row, _)| Some(self.press_of[**row]) != held);
        (target.rows, target.measured) = rows.map(|(&row, &measured)| (row, measured)).unzip();
        can_be_learned(&target).then_some(target)
    }

    /// Cross-validation folds that hold out one press each. They contain indices into `rows`.
    pub fn folds(&self, rows: &[usize]) -> Vec<Fold> {
        let folds = (0..self.presses).map(|press| {
            let places = 0..rows.len();
            let held: Vec<_> = places
                .filter(|&place| self.press_of[rows[place]] == press)
                .collect();
            Fold {
                hidden: held.clone(),
                held,
            }
        });
        folds.filter(|fold| !fold.held.is_empty()).collect()
    }
}

/// Index of the press of each row, given the rows of each press.
fn press_of(presses: &[Vec<usize>], recording_of: &[usize]) -> Vec<usize> {
    let mut press_of = vec![0; recording_of.len()];
    let starts: Vec<_> = presses
        .iter()
        .filter_map(|press| press.first().copied())
        .collect();
    for rows in by_recording(recording_of) {
        let [Some(&first), Some(&last)] = [rows.first(), rows.last()] else {
            continue;
        };
        let before = starts.partition_point(|&start| start < first);
        for row in rows {
            let started = starts.partition_point(|&start| start <= row);
            let own = started
                .max(before + 1)
                .min(starts.partition_point(|&start| start <= last));
            press_of[row] = own.saturating_sub(1);
        }
    }
    press_of
}
