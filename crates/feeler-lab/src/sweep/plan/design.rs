//! Experimental design for success rates and sensitivity indices: the parameter values of each trial.
//!
//! Rows are points of a Sobol' sequence with Owen scrambling. Pair `n` of rows is point `n` of the sequence in twice
//! as many dimensions as there are parameters: the first half is row `2 n`, which belongs to matrix A, and the second
//! half is row `2 n + 1` of matrix B (Saltelli et al., Computer Physics Communications 181, 2010). Each row has a
//! separate seed for random effects within a run. A trial depends only on the seed of the sweep, its number and the
//! design.

use super::ranges::Entry;
use serde::{Deserialize, Serialize};

/// Maximum number of parameters, limited by the dimensions of the sequence.
pub const MAX_PARAMETERS: usize = sobol_burley::NUM_DIMENSIONS as usize / 2;
/// Maximum number of rows, limited by the points of the sequence.
pub const MAX_ROWS: u64 = 2 << 16;

/// Number of trials of each kind, in the order in which they run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// Number of rows with all parameters varied, taken alternately from the Saltelli matrices A and B.
    pub rows: u64,
    /// Number of control trials: for each group of parameters, this many rows with only that group varied, and the
    /// same number with only the seed varied.
    pub controls: u64,
    /// Number of pairs of rows (A, B) that are also run once per factor, with only that factor of row A taken from
    /// row B.
    pub pairs: u64,
}

/// A factor that can be swapped between two rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Factor {
    /// Name of the factor.
    pub name: String,
    /// Indices of its parameters.
    pub parameters: Vec<usize>,
    /// `true` if the seed of the run is swapped, too.
    pub seed: bool,
}

/// Name of the factor that consists of the run's seed.
pub const RUN_SEED: &str = "the run's own seed";

/// Kind of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// All parameters and the seed are those of a row.
    Row(u64),
    /// The parameters of one group are those of a row; the others are nominal.
    Only {
        /// Index of the group.
        group: usize,
        /// Index of the row.
        row: u64,
    },
    /// All parameters are nominal; the seed is that of a row.
    Nominal(u64),
    /// Row A of a pair with one factor taken from row B.
    Swapped {
        /// Index of the pair.
        pair: u64,
        /// Index of the factor.
        factor: usize,
    },
}

/// A design applied to a list of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Scheme {
    design: Design,
    /// Names of the groups; empty if there is only one.
    pub groups: Vec<String>,
    /// Each parameter, the run's seed, and each group.
    pub factors: Vec<Factor>,
    count: usize,
}

impl Scheme {
    /// Applies `design` to the parameters `entries`.
    pub fn new(design: Design, entries: &[Entry]) -> Self {
        let mut groups: Vec<String> = Vec::new();
        for entry in entries {
            if !groups.contains(&entry.group) {
                groups.push(entry.group.clone());
            }
        }
        if groups.len() == 1 {
            groups.clear();
        }
        let own = |(index, entry): (usize, &Entry)| (entry.name.clone(), vec![index], false);
        let all = |group: &String| {
            let inside = (0..entries.len()).filter(|&i| entries[i].group == *group);
            (format!("all of {group}"), inside.collect(), false)
        };
        let factors = (entries.iter().enumerate().map(own))
            .chain([(RUN_SEED.to_string(), Vec::new(), true)])
            .chain(groups.iter().map(all));
        let factors = factors.map(|(name, parameters, seed)| Factor {
            name,
            parameters,
            seed,
        });
        Self {
            design,
            factors: factors.collect(),
            groups,
            count: entries.len(),
        }
    }

    /// Total number of trials.
    pub fn trials(&self) -> u64 {
        let Design { rows, pairs, .. } = self.design;
        rows + self.controls() + pairs * self.factors.len() as u64
    }

    fn controls(&self) -> u64 {
        self.design.controls * (self.groups.len() as u64 + 1)
    }

    /// Numbers of the trials with all parameters varied.
    pub fn rows(&self) -> std::ops::Range<u64> {
        0..self.design.rows
    }

    /// Numbers of the trials that vary only one group, or only the seed if `group` is `None`.
    pub fn only(&self, group: Option<usize>) -> std::ops::Range<u64> {
        let block = group.map_or(0, |group| group as u64 + 1);
        let start = self.design.rows + block * self.design.controls;
        start..start + self.design.controls
    }

    /// Returns, for each pair of rows A and B, the numbers of three trials: A, B, and A with `factor` taken from B.
    pub fn swaps(&self, factor: usize) -> impl Iterator<Item = [u64; 3]> + use<> {
        let start = self.design.rows + self.controls() + factor as u64;
        let step = self.factors.len() as u64;
        (0..self.design.pairs).map(move |pair| [2 * pair, 2 * pair + 1, start + pair * step])
    }

    /// Returns the kind of a trial.
    pub fn kind(&self, trial: u64) -> Kind {
        let Design { rows, controls, .. } = self.design;
        let Some(past) = trial.checked_sub(rows) else {
            return Kind::Row(trial);
        };
        if past < self.controls() {
            let row = past % controls;
            return match past / controls {
                0 => Kind::Nominal(row),
                block => Kind::Only {
                    group: block as usize - 1,
                    row,
                },
            };
        }
        let past = past - self.controls();
        let factors = self.factors.len() as u64;
        Kind::Swapped {
            pair: past / factors,
            factor: (past % factors) as usize,
        }
    }

    /// Returns the row of each parameter of a trial (`None`: nominal), and the row of its seed.
    pub fn sources(&self, trial: u64) -> (Vec<Option<u64>>, u64) {
        let mut sources = vec![None; self.count];
        match self.kind(trial) {
            Kind::Row(row) => {
                sources.fill(Some(row));
                (sources, row)
            }
            Kind::Nominal(row) => (sources, row),
            Kind::Only { group, row } => {
                let all = &self.factors[self.count + 1 + group];
                (all.parameters.iter()).for_each(|&index| sources[index] = Some(row));
                (sources, row)
            }
            Kind::Swapped { pair, factor } => {
                let (a, b) = (2 * pair, 2 * pair + 1);
                let factor = &self.factors[factor];
                sources.fill(Some(a));
                (factor.parameters.iter()).for_each(|&index| sources[index] = Some(b));
                (sources, if factor.seed { b } else { a })
            }
        }
    }

    /// Returns the coordinate (0 to below 1) of a row along a parameter in the sequence with the scrambling key `key`.
    pub fn coordinate(&self, row: u64, parameter: usize, key: u32) -> f64 {
        let dimension = parameter as u64 + (row % 2) * self.count as u64;
        // The numbers of rows and parameters are limited to the size of the sequence.
        f64::from(sobol_burley::sample(
            (row / 2) as u32,
            dimension as u32,
            key,
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scheme(groups: &[&str]) -> Scheme {
        let entry = |(index, group): (usize, &&str)| Entry {
            name: index.to_string(),
            group: group.to_string(),
            unit: String::new(),
            key: None,
            keys: Vec::new(),
            of: None,
            power: None,
            range: String::new(),
            why: String::new(),
        };
        let entries: Vec<_> = groups.iter().enumerate().map(entry).collect();
        let design = Design {
            rows: 8,
            controls: 3,
            pairs: 2,
        };
        Scheme::new(design, &entries)
    }

    #[test]
    fn every_trial_has_one_kind_and_swaps_only_its_factor() {
        let scheme = scheme(&["a", "b", "a"]);
        // 8 rows, 3 control trials each for nominal, a and b; 2 pairs with 3 parameters, the seed and 2 groups.
        assert_eq!(scheme.trials(), 8 + 9 + 12);
        assert_eq!(scheme.sources(5), (vec![Some(5); 3], 5));
        assert_eq!(
            scheme.only(None).map(|k| scheme.kind(k)).next_back(),
            Some(Kind::Nominal(2))
        );
        for trial in scheme.only(Some(0)) {
            let row = trial - 11;
            assert_eq!(
                scheme.sources(trial),
                (vec![Some(row), None, Some(row)], row)
            );
        }
        let swapped: Vec<_> = (0..6)
            .map(|factor| scheme.swaps(factor).last().unwrap())
            .collect();
        let from = |factor: usize| scheme.sources(swapped[factor][2]);
        let (a, b) = (2, 3);
        assert!(swapped.iter().all(|s| s[..2] == [a, b]));
        assert_eq!(from(1), (vec![Some(a), Some(b), Some(a)], a));
        assert_eq!(from(3), (vec![Some(a); 3], b));
        assert_eq!(from(4), (vec![Some(b), Some(a), Some(b)], a));
        assert_eq!(swapped[5][2] + 1, scheme.trials());
    }

    #[test]
    fn a_single_group_has_no_control_runs() {
        assert_eq!(scheme(&["a", "a"]).trials(), 8 + 3 + 2 * 3);
    }

    /// The first 2^m points of a scrambled Sobol' sequence have exactly one point in each of 2^m equal slices of every
    /// dimension. Independent draws would leave more than a third of the slices empty.
    #[test]
    fn rows_fill_the_space() {
        let scheme = scheme(&["a"; 40]);
        for parameter in 0..40 {
            for matrix in 0..2 {
                let mut hit = [0; 64];
                for pair in 0..64 {
                    let x = scheme.coordinate(2 * pair + matrix, parameter, 7);
                    hit[(64.0 * x) as usize] += 1;
                }
                assert_eq!(hit, [1; 64], "{parameter} {matrix}");
            }
        }
        assert_ne!(scheme.coordinate(0, 0, 7), scheme.coordinate(0, 0, 8));
    }
}
