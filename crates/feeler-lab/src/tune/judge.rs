//! A simulated run of an experiment, judged by the claims about the hand.

use super::TuneError;
use crate::config::Experiment;
use crate::experiment::{Pictures, Session};
use feeler::control::phase::Phase;
use feeler_report::tasks;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;

/// Number of claims that a run is judged by.
pub const CLAIMS: usize = 5;
/// The claims that a run is judged by: what the hand does, not how a torque sensor shows it.
pub const CLAIM_IDS: [&str; CLAIMS] = [
    "path-follows-contour",
    "path-is-curved",
    "slip-means-slip",
    "no-damage",
    "closed-after-third",
];

/// Margin of each claim, relative to its bound, from -1 to 1; -1 where it is not measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins(pub [f64; CLAIMS]);

/// Margins of a run that did not end its task, or could not begin.
pub const FAILED: Margins = Margins([-1.0; CLAIMS]);

/// Width over which [`Margins::score`] rises from failure to success.
const WIDTH: f64 = 0.08;
/// Weight of the mean of the margins that are missed, which leads out of hopeless settings.
const MISSED: f64 = 0.3;

impl Margins {
    /// The smallest margin.
    pub fn least(&self) -> f64 {
        self.0.iter().copied().fold(1.0, f64::min)
    }

    /// Whether all claims hold.
    pub fn hold(&self) -> bool {
        self.0.iter().all(|margin| *margin >= 0.0)
    }

    /// What a search maximises: a smooth step of the smallest margin, and a slope towards it.
    pub fn score(&self) -> f64 {
        let step = 1.0 / (1.0 + (-self.least() / WIDTH).exp());
        let missed = self.0.iter().map(|m| m.clamp(-1.0, 0.05)).sum::<f64>();
        step + MISSED * missed / CLAIMS as f64
    }
}

/// Simulates `experiment` once and measures its claims. An experiment that cannot be run has [`FAILED`].
///
/// # Errors
/// If the run cannot be recorded in memory, or a simulated sensor fails.
pub fn judge(experiment: &Experiment) -> Result<Margins, TuneError> {
    let Ok(mut session) = Session::drawing(experiment, Pictures::Sensed) else {
        return Ok(FAILED);
    };
    let (recording, data) = session.run_in_memory(&experiment.config)?;
    if session.control_loop().controller().phase() != Phase::Done {
        return Ok(FAILED);
    }
    let strokes = data.stroke_measures();
    let claims = tasks::of_recording(&recording).claims(&recording, &data, &strokes);
    Ok(Margins(CLAIM_IDS.map(|id| {
        let claim = claims.iter().find(|claim| claim.id == id);
        let margin = claim.and_then(|claim| claim.margin());
        margin.map_or(-1.0, |margin| margin.clamp(-1.0, 1.0))
    })))
}

/// Margins of each of `experiments`, on `jobs` threads; `None` if `stop` was raised meanwhile.
///
/// # Errors
/// As [`judge`].
pub fn judge_all(
    experiments: &[Experiment],
    jobs: usize,
    stop: &AtomicBool,
) -> Result<Option<Vec<Margins>>, TuneError> {
    let next = AtomicUsize::new(0);
    let (finished, results) = channel();
    thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, experiments.len().max(1)) {
            let (finished, next) = (finished.clone(), &next);
            scope.spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(experiment) = experiments.get(index) else {
                        break;
                    };
                    if finished.send((index, judge(experiment))).is_err() {
                        break;
                    }
                }
            });
        }
    });
    drop(finished);
    let mut margins = vec![FAILED; experiments.len()];
    let mut count = 0;
    for (index, result) in results {
        margins[index] = result?;
        count += 1;
    }
    Ok((count == experiments.len()).then_some(margins))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_miss_scores_higher() {
        let with = |least: f64| Margins([0.2, 0.2, least, 0.2, 0.2]);
        let scores = [-1.0, -0.5, -0.05, 0.0, 0.1].map(|least| with(least).score());
        assert!(scores.is_sorted(), "{scores:?}");
        assert!(with(0.0).hold() && !with(-0.01).hold());
    }
}
