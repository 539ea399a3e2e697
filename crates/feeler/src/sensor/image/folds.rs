//! Division of calibration loads into folds for cross-validation.

use glam::DVec3;
use std::collections::HashMap;

/// Number of folds.
const FOLDS: usize = 5;

/// Loads divided into five folds for cross-validation. The division is deterministic.
///
/// Equal forces are in the same fold, because predicting a force that is part of the fit would not be a test.
/// Consecutive loads are distributed over the folds, so that no fold contains an entire sweep.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::sensor) struct Folds {
    fold_of: Vec<usize>,
}

impl Folds {
    /// Distributes the loads with these forces over the folds.
    pub(in crate::sensor) fn new(forces: &[DVec3]) -> Self {
        let mut groups: HashMap<[u64; 3], usize> = HashMap::new();
        let group_of: Vec<_> = (forces.iter())
            .map(|force| {
                let next = groups.len();
                *groups
                    .entry(force.to_array().map(f64::to_bits))
                    .or_insert(next)
            })
            .collect();
        // Multiplying by a large odd number scatters evenly spaced groups.
        let mut order: Vec<usize> = (0..groups.len()).collect();
        order.sort_by_key(|&group| (group as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 20);
        let mut fold_of_group = vec![0; groups.len()];
        for (rank, group) in order.into_iter().enumerate() {
            fold_of_group[group] = rank % FOLDS;
        }
        Self {
            fold_of: group_of.into_iter().map(|g| fold_of_group[g]).collect(),
        }
    }

    /// Indices of the folds.
    pub(in crate::sensor) fn all(&self) -> impl Iterator<Item = usize> + use<> {
        0..FOLDS
    }

    /// Indices of the loads in a fold.
    pub(in crate::sensor) fn own(&self, fold: usize) -> Vec<usize> {
        self.rows(|other| other == fold)
    }

    /// Indices of the loads in all other folds.
    pub(in crate::sensor) fn others(&self, fold: usize) -> Vec<usize> {
        self.rows(|other| other != fold)
    }

    fn rows(&self, wanted: impl Fn(usize) -> bool) -> Vec<usize> {
        let rows = self.fold_of.iter().enumerate();
        rows.filter(|&(_, &fold)| wanted(fold))
            .map(|(row, _)| row)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_load_is_left_out_once_together_with_equal_ones() {
        let forces: Vec<_> = (0..100).map(|i| DVec3::splat(f64::from(i % 37))).collect();
        let folds = Folds::new(&forces);
        let mut left_out = vec![0; forces.len()];
        for fold in folds.all() {
            let (own, others) = (folds.own(fold), folds.others(fold));
            assert_eq!(own.len() + others.len(), forces.len());
            assert!(own.len() >= 12, "{own:?}");
            for row in own {
                left_out[row] += 1;
                assert!(others.iter().all(|&other| forces[other] != forces[row]));
            }
        }
        assert!(left_out.iter().all(|&times| times == 1));
    }
}
