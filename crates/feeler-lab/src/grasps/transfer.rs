//! Performance of a detector whose threshold was chosen on other data, such as simulations or another sensor.

use super::outcome::{Judged, Labelled, best_threshold, judge, known};

/// Performance of a detector on recordings with thresholds from other data.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// Threshold chosen on the other data; infinite if the same answer for all samples is best on them.
    pub threshold: f64,
    /// Classification with [`threshold`](Self::threshold).
    pub alone: Judged,
    /// Classification of each group with a threshold chosen on the other data and the remaining groups together. The
    /// other data and all groups have equal total weights.
    pub added: Judged,
}

/// Classifies `samples` with thresholds chosen on `others` alone, and on both. Returns `None` if `others` have no
/// scores.
///
/// The group numbers of `samples` and `others` are unrelated.
pub fn transfer(others: &[Labelled], samples: &[Labelled]) -> Option<Transfer> {
    let (mut taught, mut known) = (known(others), known(samples));
    if taught.is_empty() {
        return None;
    }
    let threshold = best_threshold(taught.iter());
    let alone = judge(&known, samples.len(), |_| Some(threshold));
    let counts = (taught.len() as u64, known.len() as u64);
    taught.iter_mut().for_each(|k| k.weight = counts.1);
    known.iter_mut().for_each(|k| k.weight = counts.0);
    let together = |group: usize| {
        let own = known.iter().filter(|k| k.group != group);
        let mut all: Vec<_> = taught.iter().chain(own).collect();
        all.sort_by(|a, b| a.score.total_cmp(&b.score));
        Some(best_threshold(all.into_iter()))
    };
    Some(Transfer {
        threshold,
        alone,
        added: judge(&known, samples.len(), together),
    })
}

#[cfg(test)]
mod tests {
    use super::super::outcome::samples;
    use super::*;

    /// The others are separated at 5 and contain a non-slip with score 6. Together with the samples' other groups,
    /// which contain two such non-slips, the threshold is 7.5.
    #[test]
    fn thresholds_are_chosen_on_other_data_alone_or_combined() {
        let others = samples(&[(0, false, 4.0), (1, true, 6.0), (2, true, 9.0)]);
        let own = samples(&[
            (0, false, 6.0),
            (1, false, 6.0),
            (2, false, 6.0),
            (3, true, 9.0),
        ]);
        let transfer = transfer(&others, &own).unwrap();
        assert_eq!(transfer.threshold, 5.0);
        let right = |judged: &Judged| judged.accuracy.unwrap().mean;
        assert_eq!(
            (right(&transfer.alone), right(&transfer.added)),
            (0.25, 1.0)
        );
        assert_eq!(transfer.alone.confusion.false_alarms, 3);
        let threshold = |judged: &Judged| judged.verdicts[0].unwrap().threshold;
        assert_eq!(threshold(&transfer.alone), 5.0);
        assert_eq!(threshold(&transfer.added), 7.5);
    }

    #[test]
    fn no_threshold_without_scores() {
        let unknown = Labelled {
            group: 0,
            slip: true,
            score: None,
        };
        assert_eq!(transfer(&[unknown], &samples(&[(0, true, 1.0)])), None);
        let none = transfer(&samples(&[(0, true, 1.0), (1, false, 0.0)]), &[unknown]).unwrap();
        assert_eq!((none.alone.accuracy, none.added.accuracy), (None, None));
    }
}
