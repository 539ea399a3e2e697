//! Search for settings with which the claims pass over draws of all uncertain values.

use super::TuneError;
use super::hand::Hand;
use super::judge::{Margins, judge_all};
use super::optimizer::Optimizer;
use super::rules::SETTINGS;
use super::settings::Settings;
use super::uncertainty::Uncertainty;
use crate::config::Experiment;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Number of candidate settings per generation.
const CANDIDATES: usize = 10;
/// Number of draws with which each candidate is simulated.
const DRAWS: u64 = 12;
/// Number of simulated runs per generation.
pub const GENERATION: u64 = CANDIDATES as u64 * DRAWS;
/// Initial standard deviation about the rules. It is relative because the search is logarithmic.
const STEP: f64 = 0.15;
/// First draw used by a search. Draws below are reserved for [predictions](super::predict).
const FIRST_DRAW: u64 = 1 << 32;

/// Limits of a search, which ends at the first one reached.
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    /// Wall-clock time, if limited.
    pub time: Option<Duration>,
    /// Number of simulated runs, if limited. A search that ends at this limit is reproducible.
    pub runs: Option<u64>,
}

/// A hand to tune, and how it is simulated.
pub struct Problem<'a> {
    /// Properties of the hand.
    pub hand: Hand,
    /// Uncertain values of the hand.
    pub uncertainty: &'a Uncertainty,
    /// Speed limit of the fingertips (m/s).
    pub fingertip_speed: f64,
    /// Number of threads.
    pub jobs: usize,
    /// Ends a search or prediction when set.
    pub stop: &'a AtomicBool,
}

/// Result of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Best settings found.
    pub settings: Settings,
    /// Number of simulated runs.
    pub runs: u64,
}

impl Problem<'_> {
    /// Returns the settings of the rules with `offsets` added to the logarithms of their ratios.
    pub fn settings(&self, offsets: &[f64; SETTINGS]) -> Settings {
        Settings::new(&self.hand, offsets, self.fingertip_speed)
    }

    /// Applies `settings` to each of `draws`.
    fn simulated(&self, settings: &Settings, draws: &[Experiment]) -> Vec<Experiment> {
        let mut experiments = draws.to_vec();
        for experiment in &mut experiments {
            settings.apply(&mut experiment.config, self.hand.pivot);
        }
        experiments
    }
}

/// Searches around the rules until the `budget` is used up or the problem's `stop` is set, and returns the best
/// estimate. `progress` is called after each generation with the number of runs and the best candidate's score.
///
/// # Errors
/// If no valid experiment can be drawn, or a run fails.
pub fn search(
    problem: &Problem<'_>,
    budget: Budget,
    seed: u64,
    progress: &mut dyn FnMut(u64, f64),
) -> Result<Found, TuneError> {
    let start = Instant::now();
    let mut optimizer = Optimizer::new([0.0; SETTINGS], STEP, seed);
    let mut runs = 0;
    let has_time = || budget.time.is_none_or(|time| start.elapsed() < time);
    let has_runs = |runs| budget.runs.is_none_or(|most| runs + GENERATION <= most);
    while has_time() && has_runs(runs) {
        let draw = |k| Ok(problem.uncertainty.draw(FIRST_DRAW + runs + k)?.experiment);
        let draws: Result<Vec<Experiment>, TuneError> = (0..DRAWS).map(draw).collect();
        let draws = draws?;
        let candidates = optimizer.ask(CANDIDATES);
        let experiments = candidates.iter();
        let experiments = experiments.flat_map(|c| problem.simulated(&problem.settings(c), &draws));
        let experiments: Vec<_> = experiments.collect();
        let Some(margins) = judge_all(&experiments, problem.jobs, problem.stop)? else {
            break;
        };
        let scores: Vec<f64> = margins.chunks(draws.len()).map(score).collect();
        optimizer.tell(&scores);
        runs += GENERATION;
        progress(
            runs,
            scores.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        );
    }
    let settings = problem.settings(&optimizer.mean);
    Ok(Found { settings, runs })
}

/// Mean score of several runs.
pub fn score(margins: &[Margins]) -> f64 {
    margins.iter().map(Margins::score).sum::<f64>() / margins.len().max(1) as f64
}
