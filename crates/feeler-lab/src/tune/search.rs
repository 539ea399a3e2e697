//! Search for settings that keep the claims over draws of everything that remains uncertain.

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

/// Settings that are compared in a generation.
const CANDIDATES: usize = 10;
/// Draws that each of them is simulated with.
const DRAWS: u64 = 12;
/// Simulated runs of a generation.
pub const GENERATION: u64 = CANDIDATES as u64 * DRAWS;
/// Standard deviation of the first candidates about the rules: relative, as settings are searched on a logarithmic scale.
const STEP: f64 = 0.15;
/// The draws of a search begin here; those below are kept for [predictions](super::predict).
const FIRST_DRAW: u64 = 1 << 32;

/// When a search ends: at the first of these.
#[derive(Debug, Clone, Copy)]
pub struct Budget {
    /// Wall time, if limited.
    pub time: Option<Duration>,
    /// Number of simulated runs, if limited. A search that ends by it is reproducible.
    pub runs: Option<u64>,
}

/// A hand to tune, and how it is simulated.
pub struct Problem<'a> {
    /// The hand.
    pub hand: Hand,
    /// What remains uncertain of it.
    pub uncertainty: &'a Uncertainty,
    /// Limit of commanded speeds, m/s.
    pub fingertip_speed: f64,
    /// Number of threads.
    pub jobs: usize,
    /// Ends a search or prediction once it is raised.
    pub stop: &'a AtomicBool,
}

/// Result of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The settings.
    pub settings: Settings,
    /// Number of simulated runs.
    pub runs: u64,
}

impl Problem<'_> {
    /// The settings with these `offsets` of the rules' logarithms.
    pub fn settings(&self, offsets: &[f64; SETTINGS]) -> Settings {
        Settings::new(&self.hand, offsets, self.fingertip_speed)
    }

    /// The experiments of `draws` with `settings`.
    fn simulated(&self, settings: &Settings, draws: &[Experiment]) -> Vec<Experiment> {
        let mut experiments = draws.to_vec();
        for experiment in &mut experiments {
            settings.apply(&mut experiment.config, self.hand.pivot);
        }
        experiments
    }
}

/// Searches about the rules until the `budget` is spent or the problem's `stop` is raised; the best estimate so far is
/// returned. `progress` is called after each generation with the number of runs and the best candidate's score.
///
/// # Errors
/// If nothing valid can be drawn, or a run fails.
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
