//! How well a detector does with a threshold that was learnt elsewhere: in simulation, or on another sensor.

use super::outcome::{Judged, Labelled, best_threshold, judge, known};

/// How a detector does on some recordings with what others taught it.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// The threshold that the others alone choose; infinite where "always" or "never" is best on them.
    pub threshold: f64,
    /// With that threshold.
    pub alone: Judged,
    /// With thresholds that are each chosen on the others and on all other groups together, where both count as much.
    pub added: Judged,
}

/// Judges `samples` by thresholds that `others` choose, alone or with them; none where the detector says nothing of the others.
///
/// Groups of `samples` and of `others` have nothing to do with each other.
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

    /// The others part at 5 and call 6 a slip that is none; with the samples' own groups, whose 6 is none twice, it is 7.5.
    #[test]
    fn others_choose_the_threshold_alone_or_with_other_groups() {
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
    fn others_of_which_nothing_is_said_choose_none() {
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
