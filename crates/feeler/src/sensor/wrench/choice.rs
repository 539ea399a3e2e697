//! Chooses terms and penalty by cross-validation over blocks of time.

use super::WrenchAxis;
use super::basis::{Basis, matrix};
use super::blocks::{Fold, blocks};
use super::ridge::Spectrum;

/// Numbers of blocks into which recordings are divided. Two divisions reduce the influence of where the boundaries lie.
const CUTS: [usize; 2] = [5, 8];
/// Values of n for the candidate penalties `10^(n/2)`. Features have a variance of 1.
const HALF_DECADES: std::ops::RangeInclusive<i32> = -4..=12;
/// Minimum decrease of the mean error, in standard errors, for a set of terms with lower preference to be chosen. Among
/// many candidates, one is better by chance.
const WORTH: f64 = 1.0;
/// Like [`WORTH`], but for less reliable terms ([`Basis::is_prone_to_overfitting`]).
const WORTH_OF_DOUBTFUL: f64 = 3.0;
/// Maximum ratio of the mean square error of less reliable terms to that of the other terms.
const LEFT_BY_DOUBTFUL: f64 = 0.5;

/// Maximum number of rows in the second comparison.
const MAX_ROWS_AGAIN: usize = 600;

/// Terms and ridge penalty chosen for a component.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Choice<T> {
    pub terms: T,
    /// Penalty for the regression on all rows: that of the compared rows, times the number of rows per compared row.
    pub penalty: f64,
    /// Squared error of each row when its block is held out, averaged over the divisions into blocks.
    squares: Vec<f64>,
}

impl<T: Copy> Choice<T> {
    fn score(&self) -> f64 {
        self.squares.iter().sum::<f64>() / self.squares.len() as f64
    }

    /// Returns `true` if the errors are significantly smaller than those of `other`. Compares magnitudes, because
    /// squares may be dominated by a single image.
    fn is_worth_more<B: Basis<Terms = T>>(&self, other: &Self) -> bool {
        match B::is_prone_to_overfitting(self.terms, other.terms) {
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

/// A component's measured values, and the rows in which it was measured.
pub(super) struct Target {
    pub axis: WrenchAxis,
    pub rows: Vec<usize>,
    pub measured: Vec<f64>,
}

/// Chooses terms and penalty for each of `targets`; `None` if no regression has a finite solution.
///
/// All candidates are compared on at most [`Basis::MAX_ROWS`] rows. If there are more rows, the best candidate is
/// compared again, on up to 600 rows, with all candidates of few terms.
pub(super) fn choose<B: Basis>(
    basis: &B,
    features: &[Vec<f64>],
    recording_of: &[usize],
    targets: &[Target],
) -> Vec<Option<Choice<B::Terms>>> {
    let mut chosen: Vec<Option<Choice<B::Terms>>> = vec![None; targets.len()];
    for (first, target) in targets.iter().enumerate() {
        // Components measured on the same rows share the expensive decompositions.
        let same = |other: &Target| other.rows == target.rows;
        if targets[..first].iter().any(same) {
            continue;
        }
        let of_target = targets.iter().zip(&mut chosen);
        let mut of_target: Vec<_> = of_target.filter(|(target, _)| same(target)).collect();
        let count = target.rows.len();
        let step = count.div_ceil(B::MAX_ROWS).max(1);
        let compared = Compared::new((0..count).step_by(step).collect(), recording_of, target);
        for terms in basis.candidates() {
            let spectrum = compared.spectrum(basis, features, terms);
            for (target, chosen) in &mut of_target {
                keep_better::<B>(chosen, compared.best(&spectrum, target, terms));
            }
        }
        if B::MAX_ROWS < MAX_ROWS_AGAIN && count > B::MAX_ROWS {
            let most = count.min(MAX_ROWS_AGAIN);
            let places = (0..most).map(|row| row * count / most).collect();
            let compared = Compared::new(places, recording_of, target);
            compare_again(basis, features, &compared, &mut of_target);
        }
    }
    chosen
}

/// Compares the choice for each target again, on more rows, with all candidates of at most [`Basis::MAX_ROWS`] terms.
fn compare_again<B: Basis>(
    basis: &B,
    features: &[Vec<f64>],
    compared: &Compared,
    targets: &mut [(&Target, &mut Option<Choice<B::Terms>>)],
) {
    let terms_of = |choice: Option<Choice<B::Terms>>| choice.map(|choice| choice.terms);
    let mut best: Vec<_> = (targets.iter_mut())
        .map(|(_, chosen)| terms_of(chosen.take()))
        .collect();
    while let Some(terms) = best.iter().copied().flatten().next() {
        let spectrum = compared.spectrum(basis, features, terms);
        for ((target, chosen), best) in targets.iter_mut().zip(&mut best) {
            if best.take_if(|best| *best == terms).is_some() {
                **chosen = compared.best(&spectrum, target, terms);
            }
        }
    }
    let few = |terms: &B::Terms| basis.term_count(*terms) <= B::MAX_ROWS;
    for terms in basis.candidates().into_iter().filter(few) {
        let spectrum = compared.spectrum(basis, features, terms);
        for (target, chosen) in targets.iter_mut() {
            keep_better::<B>(chosen, compared.best(&spectrum, target, terms));
        }
    }
}

/// Replaces `chosen` with `other` if it is better.
fn keep_better<B: Basis>(chosen: &mut Option<Choice<B::Terms>>, other: Option<Choice<B::Terms>>) {
    let is_better = |other: &Choice<B::Terms>| {
        let chosen = chosen.as_ref();
        chosen.is_none_or(|chosen| other.is_worth_more::<B>(chosen))
    };
    if let Some(other) = other.filter(is_better) {
        *chosen = Some(other);
    }
}

/// Subset of a target's rows on which candidates are compared.
struct Compared {
    /// Indices of the subset among the rows of the target.
    places: Vec<usize>,
    /// Indices of the subset in the features.
    rows: Vec<usize>,
    cuts: [Vec<Fold>; 2],
    /// Number of rows of the target per compared row.
    factor: f64,
}

impl Compared {
    /// Selects the rows at the indices `places` of `target`.
    fn new(places: Vec<usize>, recording_of: &[usize], target: &Target) -> Self {
        let rows: Vec<_> = places.iter().map(|&place| target.rows[place]).collect();
        let recordings: Vec<_> = rows.iter().map(|&row| recording_of[row]).collect();
        Self {
            cuts: CUTS.map(|count| blocks(&recordings, count)),
            factor: target.rows.len() as f64 / rows.len() as f64,
            places,
            rows,
        }
    }

    fn spectrum<B: Basis>(&self, basis: &B, features: &[Vec<f64>], terms: B::Terms) -> Spectrum {
        Spectrum::new(matrix(basis, features, &self.rows, terms))
    }

    /// Best penalty for `target` with `terms`.
    fn best<T: Copy>(&self, spectrum: &Spectrum, target: &Target, terms: T) -> Option<Choice<T>> {
        let measured = self.places.iter().map(|&place| target.measured[place]);
        let measured: Vec<_> = measured.collect();
        let mut best = best_penalty(spectrum, &measured, terms, &self.cuts, Shrinkage::Moderate)?;
        best.penalty *= self.factor;
        Some(best)
    }
}

/// Rule for choosing a penalty in the range from the best one to the largest one that is not significantly worse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shrinkage {
    /// The geometric mean of the range. Weights smaller than those of the best penalty reduce the effect of drift
    /// between recordings, which held-out blocks of the same recording do not show. The largest penalty would discard
    /// too much information.
    Moderate,
    /// The largest penalty (one-standard-error rule; Hastie, Tibshirani and Friedman, The Elements of Statistical
    /// Learning, 2009, section 7.10), for corrections of a model that is good without them.
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
