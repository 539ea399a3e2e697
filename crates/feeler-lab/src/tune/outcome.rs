//! What tuning a hand results in: the tuned experiment, and its page.

use super::TuneError;
use super::hand::Hand;
use super::judge::CLAIM_IDS;
use super::predict::Prediction;
use super::rules::SETTINGS;
use super::search::{Budget, Problem, search};
use super::settings::Settings;
use super::uncertainty::Uncertainty;
use super::write::{Change, Origin, changes, tuned};
use crate::config::Experiment;
use crate::identify::Identified;
use feeler_report::tune_page::{ClaimRow, CostRow, SettingRow, TunePage};
use std::sync::atomic::{AtomicBool, Ordering};

/// Draws that a prediction is made of.
const PREDICTED: u64 = 200;

/// How to tune.
#[derive(Debug, Clone, Copy)]
pub struct TuneOptions {
    /// Rated force of an element, N; without it, [estimated](super::hand::rated_force) from the stiffness.
    pub rated_force: Option<f64>,
    /// Budget of a search; without it, the rules alone decide.
    pub search: Option<Budget>,
    /// Seed of all that is drawn.
    pub seed: u64,
    /// Number of threads.
    pub jobs: usize,
}

/// The result of tuning.
pub struct Tuned {
    /// The experiment with tuned values and their comments.
    pub experiment: Experiment,
    /// The page about it.
    pub page: TunePage,
    /// Whether the search was ended before its budget was spent.
    pub interrupted: bool,
}

/// Tunes `experiment` for its hand as it was `identified`. Raising `stop` ends a search with the best settings so far, and
/// leaves out predictions. `progress` is called with the number of simulated runs of the search, and the best score.
///
/// # Errors
/// If the experiment cannot be tuned or simulated, or a tuned value is out of its range.
pub fn tune(
    experiment: &Experiment,
    identified: &Identified,
    options: &TuneOptions,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(u64, f64),
) -> Result<Tuned, TuneError> {
    let hand = Hand::new(experiment, identified, options.rated_force)?;
    let limit = experiment.config.control.limits.fingertip_speed;
    let rules = Settings::new(&hand, &[0.0; SETTINGS], limit);
    if experiment.config.sim.is_none() && options.search.is_none() {
        let changes = changes(experiment, &rules, hand.pivot)?;
        let page = page(experiment, options, &changes);
        let experiment = tuned(experiment, &changes, Origin::Rules)?;
        return Ok(Tuned {
            experiment,
            page,
            interrupted: false,
        });
    }
    let uncertainty = Uncertainty::new(experiment, identified, options.seed)?;
    let problem = Problem {
        hand,
        uncertainty: &uncertainty,
        fingertip_speed: limit,
        jobs: options.jobs,
        stop,
    };
    let found = match options.search {
        Some(budget) => Some(search(&problem, budget, options.seed, progress)?),
        None => None,
    };
    // What was found until Ctrl-C is judged all the same; a second one is the system's.
    let interrupted = stop.swap(false, Ordering::Relaxed);
    let predict = |settings: Option<&Settings>| Prediction::new(&problem, settings, PREDICTED);
    let (before, by_rules) = (predict(None)?, predict(Some(&rules))?);
    let by_search = match &found {
        Some(found) => predict(Some(&found.settings))?,
        None => None,
    };
    let rules_are_better = match (&by_rules, &by_search) {
        (Some(by_rules), Some(by_search)) => by_rules.score() >= by_search.score(),
        _ => false,
    };
    let (settings, after, origin) = match &found {
        Some(found) if !rules_are_better => (found.settings, by_search, Origin::Search),
        _ => (rules, by_rules.clone(), Origin::Rules),
    };
    let changes = changes(experiment, &settings, hand.pivot)?;
    let mut page = page(experiment, options, &changes);
    page.runs = found.map_or(0, |found| found.runs);
    page.by_search = origin == Origin::Search;
    if let (Some(before), Some(by_rules), Some(after)) = (before, by_rules, after) {
        page.draws = PREDICTED;
        page.successes = [&before, &by_rules, &after].map(Prediction::successes);
        page.claims = claim_rows(&before, &after);
        page.costs = cost_rows(&uncertainty, &after);
    }
    let experiment = tuned(experiment, &changes, origin)?;
    Ok(Tuned {
        experiment,
        page,
        interrupted,
    })
}

/// A page without predictions.
fn page(experiment: &Experiment, options: &TuneOptions, changes: &[Change]) -> TunePage {
    let row = |change: &Change| SettingRow {
        key: change.key.clone(),
        unit: change.unit.to_string(),
        before: change.before,
        after: change.after,
        reason: change.reason.clone(),
    };
    TunePage {
        name: experiment.config.name.clone(),
        seed: options.seed,
        settings: changes.iter().map(row).collect(),
        ..TunePage::default()
    }
}

fn claim_rows(before: &Prediction, after: &Prediction) -> Vec<ClaimRow> {
    let share = |prediction: &Prediction, claim: usize| {
        let held = prediction.margins.iter().filter(|m| m.0[claim] >= 0.0);
        held.count() as u64
    };
    let rows = CLAIM_IDS.iter().enumerate().map(|(claim, name)| ClaimRow {
        name: name.to_string(),
        held: [share(before, claim), share(after, claim)],
        median: [before.quantile(claim, 0.5), after.quantile(claim, 0.5)],
        low: [before.quantile(claim, 0.05), after.quantile(claim, 0.05)],
    });
    rows.collect()
}

/// The uncertain values, the one whose thirds differ most in success first.
fn cost_rows(uncertainty: &Uncertainty, prediction: &Prediction) -> Vec<CostRow> {
    let rows = uncertainty
        .names()
        .enumerate()
        .map(|(index, name)| CostRow {
            name: name.to_string(),
            thirds: prediction.thirds(index),
        });
    let mut rows: Vec<_> = rows.collect();
    rows.sort_by(|a, b| b.spread().total_cmp(&a.spread()));
    rows
}
