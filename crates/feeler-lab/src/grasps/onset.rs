//! Time at which a detector reports a slip, relative to its onset and to the loss of the object.

use feeler_report::measures::percentile;
use feeler_report::pages::GraspTiming;

/// A slip in a recording. Times are those of its frames (s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlipEvent {
    /// Time at which the object starts to slide.
    pub onset: f64,
    /// Time at which the object is gone; `None` if it stays in the grip or the time is unknown.
    pub loss: Option<f64>,
    /// Time after which an alarm is not attributed to this slip.
    pub end: f64,
}

impl SlipEvent {
    /// Returns the start of the alarm that reports this slip: the one that is active at the onset, otherwise the first
    /// that starts by `end`.
    ///
    /// An alarm is active while the score is above `threshold`; a frame without a score changes nothing. `frames` are
    /// times (s) and scores in chronological order.
    pub fn alarm(
        &self,
        frames: impl IntoIterator<Item = (f64, Option<f64>)>,
        threshold: f64,
    ) -> Option<f64> {
        let mut start = None;
        for (stamp, score) in frames {
            if stamp > self.end || (start.is_some() && stamp > self.onset) {
                break;
            }
            start = match score {
                Some(score) if score > threshold => start.or(Some(stamp)),
                Some(_) => None,
                None => start,
            };
        }
        start
    }
}

/// Summarizes delays and lead times of `slips`, each with the start of its alarm (s; `None` if missed). Returns `None` if
/// `slips` is empty.
pub fn timing(slips: &[(SlipEvent, Option<f64>)]) -> Option<GraspTiming> {
    let alarms = (slips.iter()).filter_map(|(slip, alarm)| Some((slip, (*alarm)?)));
    let late = alarms.clone().filter(|(slip, alarm)| *alarm >= slip.onset);
    let delays: Vec<_> = (late.clone())
        .map(|(slip, alarm)| alarm - slip.onset)
        .collect();
    let leads: Vec<_> = late
        .filter_map(|(slip, alarm)| Some(slip.loss? - alarm))
        .collect();
    (!slips.is_empty()).then(|| GraspTiming {
        slips: slips.len(),
        early: alarms.count() - delays.len(),
        reported: delays.len(),
        losses: leads.len(),
        before_loss: leads.iter().filter(|lead| **lead > 0.0).count(),
        delay: quartiles(&delays),
        lead: quartiles(&leads),
    })
}

fn quartiles(values: &[f64]) -> Option<[f64; 3]> {
    let quartile = |percent| percentile(values.iter().copied(), percent);
    Some([quartile(25.0)?, quartile(50.0)?, quartile(75.0)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLIP: SlipEvent = SlipEvent {
        onset: 2.0,
        loss: Some(5.0),
        end: 6.0,
    };

    /// Scores at 0, 1, 2, ... s.
    fn alarm(scores: &[f64]) -> Option<f64> {
        let frames = scores.iter().enumerate();
        SLIP.alarm(frames.map(|(time, score)| (time as f64, Some(*score))), 0.5)
    }

    #[test]
    fn the_alarm_is_the_one_at_the_onset_or_the_next() {
        assert_eq!(alarm(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0]), Some(4.0));
        assert_eq!(alarm(&[0.0, 1.0, 1.0, 0.0, 1.0]), Some(1.0));
        assert_eq!(alarm(&[0.0, 0.0, 1.0]), Some(2.0));
        assert_eq!(alarm(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]), None);
        assert_eq!(alarm(&[]), None);
        let unknown = [(1.0, Some(1.0)), (2.0, None), (3.0, Some(0.0))];
        assert_eq!(SLIP.alarm(unknown, 0.5), Some(1.0));
    }

    /// Delays 1, 2 and 4 s; the loss is 3 s after the onset.
    #[test]
    fn delays_and_lead_times_have_quartiles() {
        let slips = [Some(3.0), Some(4.0), Some(6.0), Some(1.0), None].map(|alarm| (SLIP, alarm));
        let result = timing(&slips).unwrap();
        assert_eq!((result.slips, result.early, result.reported), (5, 1, 3));
        assert_eq!(result.delay, Some([1.5, 2.0, 3.0]));
        assert_eq!((result.losses, result.before_loss), (3, 2));
        assert_eq!(result.lead, Some([0.0, 1.0, 1.5]));
        assert_eq!(timing(&[]), None);
        let missed = timing(&[(SLIP, None)]).unwrap();
        assert_eq!((missed.reported, missed.delay), (0, None));
    }
}
