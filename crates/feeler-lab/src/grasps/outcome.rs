//! Evaluation of a slip detector against labels, with cross-validation over groups.

use super::confusion::Confusion;
use crate::sweep::analysis::interval::{Estimate, bootstrap_of};
use std::collections::BTreeSet;

/// A recording or a frame with its label and score.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Labelled {
    /// Group of the sample. Cross-validation and bootstrap use whole groups.
    pub group: usize,
    /// Label: whether there is slip.
    pub slip: bool,
    /// Score of the detector; higher values indicate slip. `None` if there is no score.
    pub score: Option<f64>,
}

/// Classification of one sample with the threshold chosen on all other groups.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// The threshold; infinite if the same answer for all samples is best on the other groups.
    pub threshold: f64,
    /// `true` if the score is above the threshold.
    pub says_slip: bool,
}

/// Performance of a detector.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Area under the ROC curve: the probability that a sample with slip has a higher score than one without. The 95 %
    /// interval is bootstrapped over groups. `None` if the labels are all equal.
    pub auc: Option<Estimate>,
    /// Fraction of correct classifications, each with the threshold chosen on all other groups. `None` if there is
    /// only one group.
    pub accuracy: Option<Estimate>,
    /// Threshold chosen on all groups, for use on other data.
    pub threshold: f64,
    /// Confusion matrix of the cross-validation.
    pub confusion: Confusion,
    /// Classification of each sample. `None` without a score or another group.
    pub verdicts: Vec<Option<Verdict>>,
    /// ROC curve: false positive rate and true positive rate for all thresholds, from (1, 1) to (0, 0).
    pub curve: Vec<(f64, f64)>,
    /// Number of samples without a score.
    pub unknown: usize,
}

/// A sample with a score.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub score: f64,
    pub slip: bool,
    pub group: usize,
    /// Index among all samples.
    pub index: usize,
    /// Weight in the choice of a threshold.
    pub weight: u64,
}

/// Returns the `samples` with a finite score, sorted by score.
pub(super) fn known(samples: &[Labelled]) -> Vec<Known> {
    let known = samples.iter().enumerate().filter_map(|(index, sample)| {
        let Labelled { group, slip, score } = *sample;
        let score = score.filter(|score| score.is_finite())?;
        Some(Known {
            score,
            slip,
            group,
            index,
            weight: 1,
        })
    });
    let mut known: Vec<_> = known.collect();
    known.sort_by(|a, b| a.score.total_cmp(&b.score));
    known
}

/// Returns the groups of `known`, sorted.
pub(super) fn groups_of(known: &[Known]) -> Vec<usize> {
    let groups: BTreeSet<_> = known.iter().map(|k| k.group).collect();
    groups.into_iter().collect()
}

/// Classification of samples, each with a threshold that was chosen without its group.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Fraction of correct classifications, with the 95 % interval bootstrapped over groups. `None` if nothing was
    /// classified.
    pub accuracy: Option<Estimate>,
    /// Confusion matrix.
    pub confusion: Confusion,
    /// Classification of each sample. `None` without a score or a threshold.
    pub verdicts: Vec<Option<Verdict>>,
}

/// Classifies the samples `known`, each with the threshold of its group. `samples` is the total number of samples.
pub(super) fn judge(
    known: &[Known],
    samples: usize,
    threshold_of: impl Fn(usize) -> Option<f64>,
) -> Judged {
    let mut verdicts = vec![None; samples];
    let mut confusion = Confusion::default();
    let groups = groups_of(known);
    for &group in &groups {
        let Some(threshold) = threshold_of(group) else {
            continue;
        };
        for own in known.iter().filter(|k| k.group == group) {
            let says_slip = own.score > threshold;
            verdicts[own.index] = Some(Verdict {
                threshold,
                says_slip,
            });
            confusion.add(own.slip, says_slip);
        }
    }
    let is_right = |k: &&Known| verdicts[k.index].is_some_and(|v| v.says_slip == k.slip);
    let share = |drawn: &[&usize]| {
        let weights = weights(&groups, drawn);
        let weight = |k: &Known| weights[k.group];
        let right: f64 = known.iter().filter(is_right).map(weight).sum();
        right / known.iter().map(weight).sum::<f64>()
    };
    let accuracy = bootstrap_of(&groups, share).filter(|_| confusion.count() > 0);
    Judged {
        accuracy,
        confusion,
        verdicts,
    }
}

/// Returns the number of times that each group was drawn, indexed by group.
fn weights(groups: &[usize], drawn: &[&usize]) -> Vec<f64> {
    let mut weights = vec![0.0; groups.last().map_or(0, |group| group + 1)];
    drawn.iter().for_each(|&&group| weights[group] += 1.0);
    weights
}

/// Evaluates a detector with these scores by cross-validation. Thresholds maximise the number of correct
/// classifications on all other groups. They lie midway between two scores or at infinity; among several equally good
/// ones, the middle one is used.
pub fn score(samples: &[Labelled]) -> Outcome {
    score_in_folds(samples, |group| group)
}

/// Like [`score`], but chooses each group's threshold on the groups of all other folds. `fold_of` returns a group's fold.
pub fn score_in_folds(samples: &[Labelled], fold_of: impl Fn(usize) -> usize) -> Outcome {
    let known = known(samples);
    let others = |group: usize| {
        let others = known.iter().filter(|k| fold_of(k.group) != fold_of(group));
        (others.clone().next().is_some()).then(|| best_threshold(others))
    };
    outcome(&known, samples.len(), others)
}

/// Like [`score`], with a given threshold.
pub fn score_at(samples: &[Labelled], threshold: f64) -> Outcome {
    outcome(&known(samples), samples.len(), |_| Some(threshold))
}

fn outcome(
    known: &[Known],
    samples: usize,
    threshold_of: impl Fn(usize) -> Option<f64>,
) -> Outcome {
    let groups = groups_of(known);
    let judged = judge(known, samples, threshold_of);
    Outcome {
        auc: bootstrap_of(&groups, |drawn| area(known, &weights(&groups, drawn))),
        accuracy: judged.accuracy,
        threshold: best_threshold(known.iter()),
        confusion: judged.confusion,
        curve: curve(known),
        unknown: samples - known.len(),
        verdicts: judged.verdicts,
    }
}

/// Returns the threshold that maximises the weighted number of correct classifications of `known`, which must be
/// sorted by score.
pub(super) fn best_threshold<'a>(known: impl Iterator<Item = &'a Known> + Clone) -> f64 {
    // Start with a threshold that classifies all samples as slip.
    let mut right: u64 = known.clone().filter(|k| k.slip).map(|k| k.weight).sum();
    let mut best = (right, vec![f64::NEG_INFINITY]);
    let mut rest = known.peekable();
    while let Some(passed) = rest.next() {
        right = match passed.slip {
            true => right - passed.weight,
            false => right + passed.weight,
        };
        let threshold = match rest.peek() {
            Some(next) if next.score == passed.score => continue,
            Some(next) => passed.score.midpoint(next.score),
            None => f64::INFINITY,
        };
        if right > best.0 {
            best = (right, Vec::new());
        }
        if right == best.0 {
            best.1.push(threshold);
        }
    }
    best.1[best.1.len() / 2]
}

/// Groups samples with equal scores, in ascending order.
fn tied(known: &[Known]) -> impl Iterator<Item = &[Known]> {
    known.chunk_by(|a, b| a.score == b.score)
}

/// Area under the ROC curve with weighted groups. NaN if the labels are all equal.
fn area(known: &[Known], weights: &[f64]) -> f64 {
    let (mut slips, mut others, mut area) = (0.0, 0.0, 0.0);
    for tie in tied(known) {
        let sum = |slip: bool| -> f64 {
            let own = tie.iter().filter(|k| k.slip == slip);
            own.map(|k| weights[k.group]).sum()
        };
        let (slip, other) = (sum(true), sum(false));
        area += slip * (others + 0.5 * other);
        slips += slip;
        others += other;
    }
    area / (slips * others)
}

/// ROC curve: false positive and true positive rates for increasing thresholds.
fn curve(known: &[Known]) -> Vec<(f64, f64)> {
    let all = |slip: bool| known.iter().filter(|k| k.slip == slip).count() as f64;
    let (slips, others) = (all(true), all(false));
    if slips == 0.0 || others == 0.0 {
        return Vec::new();
    }
    let (mut noticed, mut alarms) = (slips, others);
    let mut points = vec![(1.0, 1.0)];
    for tie in tied(known) {
        let slip = tie.iter().filter(|k| k.slip).count() as f64;
        noticed -= slip;
        alarms -= tie.len() as f64 - slip;
        points.push((alarms / others, noticed / slips));
    }
    points
}

/// Creates samples from groups, labels and scores.
#[cfg(test)]
pub(super) fn samples(rows: &[(usize, bool, f64)]) -> Vec<Labelled> {
    let rows = rows.iter().map(|&(group, slip, score)| Labelled {
        group,
        slip,
        score: Some(score),
    });
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counted by hand: of 3 x 2 pairs, 4 are in order and one is a tie.
    #[test]
    fn the_area_is_the_fraction_of_ordered_pairs() {
        let outcome = score(&samples(&[
            (0, true, 3.0),
            (1, true, 2.0),
            (2, true, 0.5),
            (3, false, 1.0),
            (4, false, 2.0),
        ]));
        let auc = outcome.auc.unwrap();
        assert_eq!(auc.mean, 3.5 / 6.0);
        assert!(auc.low <= auc.mean && auc.mean <= auc.high);
        assert_eq!(outcome.curve.first(), Some(&(1.0, 1.0)));
        assert_eq!(outcome.curve.last(), Some(&(0.0, 0.0)));
    }

    /// The members of a group do not affect its threshold. Without group 2, any threshold from 1 to 9 separates the
    /// others, and 5 is in the middle; with group 2, its slip with score 4 would change the threshold.
    #[test]
    fn a_threshold_does_not_depend_on_its_group() {
        let outcome = score(&samples(&[
            (0, false, 1.0),
            (1, true, 9.0),
            (2, true, 4.0),
            (2, false, 0.0),
        ]));
        let of = |index: usize| outcome.verdicts[index].unwrap();
        assert_eq!(
            of(2),
            Verdict {
                threshold: 5.0,
                says_slip: false
            }
        );
        assert!(!of(3).says_slip && of(1).says_slip);
        assert_eq!(outcome.threshold, 2.5);
        let expected = Confusion {
            noticed: 1,
            missed: 1,
            false_alarms: 0,
            quiet: 2,
        };
        assert_eq!(outcome.confusion, expected);
        assert_eq!(outcome.accuracy.unwrap().mean, 0.75);
    }

    /// Groups 0 and 1 are one fold: the threshold of group 0 is chosen on group 2 alone, between 4 and 6, although group 1
    /// would separate at 2.
    #[test]
    fn a_threshold_does_not_depend_on_its_fold() {
        let rows = samples(&[
            (0, true, 3.0),
            (1, false, 1.0),
            (1, true, 3.0),
            (2, false, 4.0),
            (2, true, 6.0),
        ]);
        let outcome = score_in_folds(&rows, |group| group / 2);
        let verdict = outcome.verdicts[0].unwrap();
        assert_eq!((verdict.threshold, verdict.says_slip), (5.0, false));
        let outcome = score_at(&rows, 2.0);
        assert_eq!(
            (outcome.confusion.missed, outcome.confusion.false_alarms),
            (0, 1)
        );
    }

    #[test]
    fn undetermined_results_are_none() {
        let unknown = Labelled {
            group: 0,
            slip: true,
            score: None,
        };
        let nan = Labelled {
            score: Some(f64::NAN),
            ..unknown
        };
        let outcome = score(&[unknown, nan]);
        assert_eq!(
            (outcome.unknown, outcome.auc, outcome.accuracy),
            (2, None, None)
        );
        let one_group = score(&samples(&[(7, true, 1.0), (7, false, 0.0)]));
        assert_eq!(one_group.accuracy, None);
        assert_eq!(one_group.auc.unwrap().mean, 1.0);
        assert_eq!(score(&[]).confusion, Confusion::default());
        // All labels are slips, so "always" has no errors.
        let all = score(&samples(&[(0, true, 1.0), (1, true, 2.0)]));
        assert_eq!((all.auc, all.confusion.noticed), (None, 2));
    }
}
