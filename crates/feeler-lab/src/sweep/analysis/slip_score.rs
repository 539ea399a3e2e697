//! Evaluation of slip detectors against the ground truth of the slip bench.

use super::interval::bootstrap_of;
use crate::experiment::slip_bench::{DETECTORS, Sample};
use crate::grasps::Confusion;
use feeler_report::pages::{OperatingPoint, Roc};

/// A slip of an element counts as new unless the element already slipped within this number of preceding frames.
const QUIET: u32 = 5;
/// Maximum delay in frames; a slip that is detected later counts as missed.
const PATIENCE: u32 = 10;
/// Precision for which thresholds are chosen: the target of 95 % plus a margin.
const PRECISION: f64 = 0.96;
/// Number of points of a curve.
const POINTS: usize = 200;

/// Classifies `samples`, element by element and frame by frame.
fn confusion(samples: &[Sample], detector: usize, threshold: f64) -> Confusion {
    let mut confusion = Confusion::default();
    for sample in samples {
        confusion.add(sample.slipped, sample.scores[detector] > threshold);
    }
    confusion
}

/// Harmonic mean of precision and recall; 0 if nothing was detected.
fn f1(confusion: Confusion) -> f64 {
    let noticed = 2.0 * confusion.noticed as f64;
    let wrong = (confusion.missed + confusion.false_alarms) as f64;
    noticed / (noticed + wrong).max(1.0)
}

/// Returns the threshold at which `detector` has the largest recall on `trials` with a precision of at least 96 %. If
/// it never reaches this precision, returns the threshold with the largest harmonic mean of precision and recall.
pub fn tune(trials: &[Vec<Sample>], detector: usize) -> f64 {
    let all = trials.concat();
    let counted = thresholds(&all, detector)
        .into_iter()
        .map(|threshold| (threshold, confusion(&all, detector, threshold)));
    let counted: Vec<_> = counted.collect();
    let precise = counted.iter().filter(|(_, c)| c.precision() >= PRECISION);
    let best = precise
        .max_by(|a, b| a.1.recall().total_cmp(&b.1.recall()))
        .or_else(|| counted.iter().max_by(|a, b| f1(a.1).total_cmp(&f1(b.1))));
    best.map_or(f64::INFINITY, |(threshold, _)| *threshold)
}

/// Evaluates `detector` on `trials` at `threshold`, with intervals bootstrapped over whole trials.
pub fn operating_point(trials: &[Vec<Sample>], detector: usize, threshold: f64) -> OperatingPoint {
    let counts: Vec<_> = trials
        .iter()
        .map(|samples| confusion(samples, detector, threshold))
        .collect();
    let estimate = |quantity: fn(Confusion) -> f64| {
        bootstrap_of(&counts, |drawn| {
            quantity(
                drawn
                    .iter()
                    .fold(Confusion::default(), |sum, &more| sum + *more),
            )
        })
        .map(|estimate| estimate.with_ends(trials.len()))
    };
    let mut delays: Vec<Option<u32>> = Vec::new();
    for samples in trials {
        delays.extend(delays_in(samples, detector, threshold));
    }
    delays.sort_by_key(|delay| delay.unwrap_or(u32::MAX));
    let never = delays.iter().filter(|delay| delay.is_none()).count();
    OperatingPoint {
        name: DETECTORS[detector],
        threshold,
        precision: estimate(Confusion::precision),
        recall: estimate(Confusion::recall),
        false_alarms: estimate(Confusion::false_alarm_rate),
        median_delay: delays.get(delays.len() / 2).copied().flatten(),
        never_noticed: (never, delays.len()),
    }
}

/// Delays in frames from the beginning of each slip to its detection; `None` if it was missed.
fn delays_in(samples: &[Sample], detector: usize, threshold: f64) -> Vec<Option<u32>> {
    let elements = samples.iter().map(|s| s.element).max().map_or(0, |e| e + 1);
    let mut delays = Vec::new();
    for element in 0..elements {
        let own: Vec<_> = samples.iter().filter(|s| s.element == element).collect();
        let mut slipped_at = None;
        for (index, sample) in own.iter().enumerate().filter(|(_, s)| s.slipped) {
            let begins = slipped_at.is_none_or(|frame| sample.frame - frame > QUIET);
            slipped_at = Some(sample.frame);
            if begins {
                let later = own[index..]
                    .iter()
                    .take_while(|s| s.frame <= sample.frame + PATIENCE);
                let noticed = later.into_iter().find(|s| s.scores[detector] > threshold);
                delays.push(noticed.map(|s| s.frame - sample.frame));
            }
        }
    }
    delays
}

/// Receiver operating characteristic: recall over false alarm rate for all thresholds.
pub fn roc(trials: &[Vec<Sample>], detector: usize) -> Roc {
    let all = trials.concat();
    let points = thresholds(&all, detector).into_iter().map(|threshold| {
        let counts = confusion(&all, detector, threshold);
        (counts.false_alarm_rate(), counts.recall())
    });
    Roc {
        name: DETECTORS[detector],
        points: std::iter::once((1.0, 1.0))
            .chain(points)
            .chain([(0.0, 0.0)])
            .collect(),
    }
}

/// Thresholds at quantiles of the scores, with the finest steps at high scores.
fn thresholds(samples: &[Sample], detector: usize) -> Vec<f64> {
    let mut scores: Vec<_> = samples.iter().map(|s| s.scores[detector]).collect();
    scores.sort_by(f64::total_cmp);
    let place = |point: usize| {
        let share = point as f64 / POINTS as f64;
        (scores.len() as f64 * (1.0 - share * share)) as usize
    };
    let points = (1..=POINTS).rev().map(place);
    points.filter_map(|at| scores.get(at).copied()).collect()
}
