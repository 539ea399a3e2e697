//! Evaluation of a simulated run by the claims about the hand.

use super::TuneError;
use crate::config::Experiment;
use crate::experiment::{Pictures, Session};
use feeler::control::Phase;
use feeler_report::tasks;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;

/// Number of evaluated claims.
pub const CLAIMS: usize = 5;
/// Evaluated claims. They concern the motion of the hand and do not depend on a torque sensor.
pub const CLAIM_IDS: [&str; CLAIMS] = [
    "path-follows-contour",
    "path-is-curved",
    "slip-means-slip",
    "no-damage",
    "closed-after-third",
];

/// Margin of each claim relative to its bound, from -1 to 1; -1 if it was not measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins(pub [f64; CLAIMS]);

/// Margins of a run that did not complete its task, or could not begin.
pub const FAILED: Margins = Margins([-1.0; CLAIMS]);

/// Width of the sigmoid in [`Margins::score`].
const WIDTH: f64 = 0.08;
/// Weight of the mean margin, which provides a gradient if the worst margin is far below zero.
const MISSED: f64 = 0.3;

impl Margins {
    /// Returns the smallest margin.
    pub fn least(&self) -> f64 {
        self.0.iter().copied().fold(1.0, f64::min)
    }

    /// Returns `true` if all claims pass.
    pub fn hold(&self) -> bool {
        self.0.iter().all(|margin| *margin >= 0.0)
    }

    /// Objective of the search: a sigmoid of the smallest margin plus a weighted mean of all margins.
    pub fn score(&self) -> f64 {
        let step = 1.0 / (1.0 + (-self.least() / WIDTH).exp());
        let missed = self.0.iter().map(|m| m.clamp(-1.0, 0.05)).sum::<f64>();
        step + MISSED * missed / CLAIMS as f64
    }
}

/// Simulates `experiment` once and evaluates its claims. Returns [`FAILED`] if the experiment cannot be run.
///
/// # Errors
/// If the run cannot be recorded in memory, or a simulated sensor fails.
pub fn judge(experiment: &Experiment) -> Result<Margins, TuneError> {
    let Ok(mut session) = Session::rendering(experiment, Pictures::Sensed) else {
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

/// Evaluates `experiments` on `jobs` threads. Returns `None` if `stop` was set meanwhile.
///
/// # Errors
/// Same as [`judge`].
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
