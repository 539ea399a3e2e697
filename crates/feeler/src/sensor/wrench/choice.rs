//! Chooses terms and penalty by cross-validation over blocks of time.

use super::WrenchAxis;
use super::basis::{Basis, matrix};
use super::blocks::{Fold, blocks};
use super::ridge::Spectrum;

/// Numbers of blocks per recording. Two partitions reduce the influence of where the cuts fall.
const CUTS: [usize; 2] = [5, 8];
/// Exponents of candidate penalties `10^(n/2)`. Features have a variance of 1.
const HALF_DECADES: std::ops::RangeInclusive<i32> = -4..=12;
/// Minimum decrease of the mean error, in standard errors, for a more complex set of terms to be preferred. Among many
/// candidates, one is better by chance.
const WORTH: f64 = 1.0;
/// Like [`WORTH`], but for doubtful terms ([`Basis::is_doubtful`]), and the maximum fraction of the mean square error
/// that may remain.
const WORTH_OF_DOUBTFUL: f64 = 3.0;
const LEFT_BY_DOUBTFUL: f64 = 0.5;

/// Maximum number of rows for which few terms, at most [`Basis::MAX_ROWS`], are compared on all rows.
const MAX_ROWS_OF_FEW: usize = 1000;

/// Terms and penalty of a component's regression.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Choice<T> {
    pub terms: T,
    /// Penalty for all rows: that of the kept rows, times the number of rows for each kept one.
    pub penalty: f64,
    /// Squared error of each compared row when its block is held out, averaged over the partitions.
    squares: Vec<f64>,
}

impl<T: Copy> Choice<T> {
    fn score(&self) -> f64 {
        self.squares.iter().sum::<f64>() / self.squares.len() as f64
    }

    /// Converts a choice from every `own_step`-th row to all rows, with errors of every `step`-th row.
    fn of_all(self, own_step: usize, step: usize) -> Self {
        let compared = self.squares.iter().step_by(step / own_step);
        Self {
            squares: compared.copied().collect(),
            penalty: self.penalty * own_step as f64,
            ..self
        }
    }

    /// Returns `true` if the errors are significantly smaller than those of `other`. Compares magnitudes, because a
    /// single image may dominate squares.
    fn is_worth_more<B: Basis<Terms = T>>(&self, other: &Self) -> bool {
        match B::is_doubtful(self.terms, other.terms) {
            true => {
                let far_less = self.score() < LEFT_BY_DOUBTFUL * other.score();
                far_less && self.is_better(other, WORTH_OF_DOUBTFUL)
            }
            false => self.is_better(other, WORTH),
        }
    }

    /// Returns `true` if the mean error magnitude is smaller than that of `other` by more than `worth` standard errors.
    fn is_better(&self, other: &Self, worth: f64) -> bool {
        let pairs = other.squares.iter().zip(&self.squares);
        let falls: Vec<f64> = pairs
            .map(|(other, own)| other.sqrt() - own.sqrt())
            .collect();
        let count = falls.len() as f64;
        let mean = falls.iter().sum::<f64>() / count;
        let variance = falls.iter().map(|fall| (fall - mean).powi(2)).sum::<f64>() / count;
        let deviation = (variance / count).sqrt();
        mean > worth * deviation
    }
}

/// Rows in which a component was measured, with the measured values.
pub(super) struct Target {
    pub axis: WrenchAxis,
    pub rows: Vec<usize>,
    pub measured: Vec<f64>,
}

/// Best choice for each of `targets`, or `None` if no regression has a finite solution.
pub(super) fn choose<B: Basis>(
    basis: &B,
    features: &[Vec<f64>],
    recording_of: &[usize],
    targets: &[Target],
) -> Vec<Option<Choice<B::Terms>>> {
    let mut chosen: Vec<Option<Choice<B::Terms>>> = vec![None; targets.len()];
    for (first, target) in targets.iter().enumerate() {
        // Components measured on the same rows share the expensive decompositions.
        let is_first = !targets[..first]
            .iter()
            .any(|other| other.rows == target.rows);
        if !is_first {
            continue;
        }
        let count = target.rows.len();
        let step = count.div_ceil(B::MAX_ROWS).max(1);
        for terms in basis.candidates() {
            // The cost depends on the smaller number of rows and terms.
            let is_small = basis.term_count(terms) <= B::MAX_ROWS && count <= MAX_ROWS_OF_FEW;
            let own_step = if is_small { 1 } else { step };
            let kept: Vec<_> = (0..count).step_by(own_step).collect();
            let rows: Vec<_> = kept.iter().map(|&place| target.rows[place]).collect();
            let recordings: Vec<_> = rows.iter().map(|&row| recording_of[row]).collect();
            let cuts = CUTS.map(|count| blocks(&recordings, count));
            let spectrum = Spectrum::new(matrix(basis, features, &rows, terms));
            for (target, chosen) in targets.iter().zip(&mut chosen).skip(first) {
                if target.rows != targets[first].rows {
                    continue;
                }
                let measured: Vec<_> = kept.iter().map(|&place| target.measured[place]).collect();
                let best = best_penalty(&spectrum, &measured, terms, &cuts, Shrinkage::Moderate);
                let best = best.map(|best| best.of_all(own_step, step));
                let better = |best: &Choice<B::Terms>| {
                    let before = chosen.as_ref();
                    before.is_none_or(|before| best.is_worth_more::<B>(before))
                };
                if let Some(best) = best.filter(better) {
                    *chosen = Some(best);
                }
            }
        }
    }
    chosen
}

/// Choice among the penalties from the best one to the largest one that is not significantly worse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shrinkage {
    /// The geometric mean of both. Smaller weights than the best ones reduce the effect of drift between recordings, which blocks of
    /// a single recording do not show. The largest penalty would discard too much information.
    Moderate,
    /// The largest (one-standard-error rule; Hastie, Tibshirani and Friedman, The Elements of Statistical Learning, 2009,
    /// section 7.10), for changes of a model that is good without them.
    Strong,
}

impl Shrinkage {
    fn between(self, best: usize, as_good: usize) -> usize {
        match self {
            Self::Moderate => best.midpoint(as_good),
            Self::Strong => as_good,
        }
    }
}

/// Chooses the penalty by cross-validation.
pub(super) fn best_penalty<T: Copy>(
    spectrum: &Spectrum,
    measured: &[f64],
    terms: T,
    cuts: &[Vec<Fold>],
    shrinkage: Shrinkage,
) -> Option<Choice<T>> {
    let penalties = HALF_DECADES.map(|power| libm::pow(10.0, f64::from(power) / 2.0));
    let penalties: Vec<_> = penalties.collect();
    let by_cut: Vec<_> = cuts
        .iter()
        .map(|folds| spectrum.errors(measured, &penalties, folds))
        .collect();
    let choices = penalties
        .iter()
        .enumerate()
        .filter_map(|(place, &penalty)| {
            let mut squares = vec![0.0; measured.len()];
            for errors in &by_cut {
                for (square, error) in squares.iter_mut().zip(errors[place].as_ref()?) {
                    *square += (*error)?.powi(2) / cuts.len() as f64;
                }
            }
            let choice = Choice {
                terms,
                penalty,
                squares,
            };
            choice.score().is_finite().then_some(choice)
        });
    let choices: Vec<_> = choices.collect();
    let places = 0..choices.len();
    let score = |place: usize| choices[place].score();
    let best = places
        .clone()
        .min_by(|&a, &b| score(a).total_cmp(&score(b)))?;
    let as_good = places
        .rev()
        .find(|&place| !choices[best].is_better(&choices[place], WORTH))?;
    choices.into_iter().nth(shrinkage.between(best, as_good))
}
