//! How well a detector tells labelled slips, on groups that its threshold was not chosen on.

use crate::sweep::interval::{Estimate, bootstrap_of};
use std::collections::BTreeSet;

/// A recording, or a frame, with its label.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Labelled {
    /// What it belongs to: all of a group are left out together, and drawn together.
    pub group: usize,
    /// Whether there is slip.
    pub slip: bool,
    /// What the detector says, the higher the surer of slip; none where it says nothing.
    pub score: Option<f64>,
}

/// What was said of one, with the threshold of all other groups.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// The threshold; infinite where "always" or "never" is best on the others.
    pub threshold: f64,
    /// Whether the score is above it.
    pub says_slip: bool,
}

/// How many were right and wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Confusion {
    /// Slips that were called so.
    pub noticed: usize,
    /// Slips that were not.
    pub missed: usize,
    /// What was no slip and called one.
    pub false_alarms: usize,
    /// What was no slip and not called one.
    pub quiet: usize,
}

impl Confusion {
    /// How many were judged.
    pub fn count(self) -> usize {
        self.noticed + self.missed + self.false_alarms + self.quiet
    }

    fn add(&mut self, slip: bool, says_slip: bool) {
        *match (slip, says_slip) {
            (true, true) => &mut self.noticed,
            (true, false) => &mut self.missed,
            (false, true) => &mut self.false_alarms,
            (false, false) => &mut self.quiet,
        } += 1;
    }
}

/// How a detector did.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Area under the curve of slips noticed over false alarms: the chance that a slip has a higher score than what is none. With
    /// the 95 % interval of drawing groups again; none where all are slips, or none is.
    pub auc: Option<Estimate>,
    /// Share that was called rightly, each with the threshold of all other groups; none with a single group.
    pub accuracy: Option<Estimate>,
    /// The threshold of all together, for use on others.
    pub threshold: f64,
    /// How many were right and wrong with thresholds of all other groups.
    pub confusion: Confusion,
    /// What was said of each; none where the detector says nothing, or there is no other group.
    pub verdicts: Vec<Option<Verdict>>,
    /// Share of false alarms, and of slips noticed, over all thresholds, from all to none.
    pub curve: Vec<(f64, f64)>,
    /// How many the detector says nothing of.
    pub unknown: usize,
}

/// One that the detector says something of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub score: f64,
    pub slip: bool,
    pub group: usize,
    /// Its number among all.
    pub index: usize,
    /// How many it counts as where a threshold is chosen.
    pub weight: u64,
}

/// Those of `samples` that the detector says something of, in the order of their scores.
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

/// The groups of those that are `known`, in order.
pub(super) fn groups_of(known: &[Known]) -> Vec<usize> {
    let groups: BTreeSet<_> = known.iter().map(|k| k.group).collect();
    groups.into_iter().collect()
}

/// Judgement of recordings, each with some threshold that was chosen without its group.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Share that was called rightly, with the 95 % interval of drawing groups again; none where nothing was judged.
    pub accuracy: Option<Estimate>,
    /// How many were right and wrong.
    pub confusion: Confusion,
    /// What was said of each; none where the detector says nothing, or there is no threshold.
    pub verdicts: Vec<Option<Verdict>>,
}

/// Judges those that are `known` among so many, each by the threshold of its group.
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

/// How often each group was drawn, by its number.
fn weights(groups: &[usize], drawn: &[&usize]) -> Vec<f64> {
    let mut weights = vec![0.0; groups.last().map_or(0, |group| group + 1)];
    drawn.iter().for_each(|&&group| weights[group] += 1.0);
    weights
}

/// How a detector with these scores does. Thresholds are those of most right on all other groups: midway between two scores,
/// or none at all, in the middle of several that are as good.
pub fn score(samples: &[Labelled]) -> Outcome {
    let known = known(samples);
    let groups = groups_of(&known);
    let others = |group: usize| {
        let others = known.iter().filter(move |k| k.group != group);
        (groups.len() > 1).then(|| best_threshold(others))
    };
    let judged = judge(&known, samples.len(), others);
    Outcome {
        auc: bootstrap_of(&groups, |drawn| area(&known, &weights(&groups, drawn))),
        accuracy: judged.accuracy,
        threshold: best_threshold(known.iter()),
        confusion: judged.confusion,
        curve: curve(&known),
        unknown: samples.len() - known.len(),
        verdicts: judged.verdicts,
    }
}

/// The threshold at which most of `known` (sorted by score) are right, as they are weighted.
pub(super) fn best_threshold<'a>(known: impl Iterator<Item = &'a Known> + Clone) -> f64 {
    // All are called slips at first.
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

/// Those of one score together, in ascending order.
fn tied(known: &[Known]) -> impl Iterator<Item = &[Known]> {
    known.chunk_by(|a, b| a.score == b.score)
}

/// Area under the curve, where each group has a weight; not a number where all are slips, or none is.
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

/// Shares of false alarms and of slips noticed as the threshold rises.
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

/// Samples of these groups, whether they slip, and scores.
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
    fn the_area_is_the_share_of_pairs_in_order() {
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

    /// The group's own members do not choose its threshold: without group 2, any from 1 to 9 parts the others, and 5 stands
    /// in the middle; with it, its slip of 4 would.
    #[test]
    fn a_threshold_is_chosen_without_its_own_group() {
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

    #[test]
    fn what_cannot_be_known_is_not_said() {
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
        // All slips: never wrong with "always".
        let all = score(&samples(&[(0, true, 1.0), (1, true, 2.0)]));
        assert_eq!((all.auc, all.confusion.noticed), (None, 2));
    }
}
