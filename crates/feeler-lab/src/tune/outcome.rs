//! Complete tuning of a hand: returns the tuned experiment and a page about it.

use super::TuneError;
use super::hand::Hand;
use super::judge::CLAIM_IDS;
use super::predict::Prediction;
use super::rules::SETTINGS;
use super::search::{Budget, Found, Problem, search};
use super::settings::Settings;
use super::uncertainty::Uncertainty;
use super::write::{Change, Origin, changes, tuned};
use crate::config::Experiment;
use crate::identify::Identified;
use feeler_report::pages::{ClaimRow, CostRow, SettingRow, TunePage};
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of simulated runs of a prediction.
const PREDICTED: u64 = 200;

/// Options of [`tune`].
#[derive(Debug, Clone, Copy)]
pub struct TuneOptions {
    /// Rated force of an element (N). If `None`, it is [estimated](super::hand::rated_force) from the stiffness.
    pub rated_force: Option<f64>,
    /// Budget of the search. If `None`, only the rules are used.
    pub search: Option<Budget>,
    /// Random seed.
    pub seed: u64,
    /// Number of threads.
    pub jobs: usize,
}

/// Result of tuning.
pub struct Tuned {
    /// The experiment with tuned values and comments.
    pub experiment: Experiment,
    /// Page about the result.
    pub page: TunePage,
    /// `true` if the search was stopped before its budget was used up.
    pub interrupted: bool,
}

/// Tunes `experiment` for the hand with the `identified` values. Setting `stop` ends a search with the best settings
/// so far, and skips the predictions. `progress` is called with the number of simulated runs of the search and the
/// best score.
///
/// # Errors
/// If the experiment cannot be tuned or simulated, or a tuned value is out of range.
pub fn tune(
    experiment: &Experiment,
    identified: &Identified,
    options: &TuneOptions,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(u64, f64),
) -> Result<Tuned, TuneError> {
    let hand = Hand::new(experiment, identified, options.rated_force)?;
    let fingertip_speed = experiment.config.control.limits.fingertip_speed;
    if experiment.config.sim.is_none() && options.search.is_none() {
        let rules = Settings::new(&hand, &[0.0; SETTINGS], fingertip_speed);
        let changes = changes(experiment, &rules, hand.pivot)?;
        return Ok(Tuned {
            experiment: tuned(experiment, &changes, Origin::Rules)?,
            page: page(experiment, options, &changes),
            interrupted: false,
        });
    }
    let uncertainty = Uncertainty::new(experiment, identified, options.seed)?;
    let problem = Problem {
        hand,
        uncertainty: &uncertainty,
        fingertip_speed,
        jobs: options.jobs,
        stop,
    };
    let found = match options.search {
        Some(budget) => Some(search(&problem, budget, options.seed, progress)?),
        None => None,
    };
    // An interrupted search is followed by predictions nevertheless; a second Ctrl-C skips them.
    let mut interrupted = stop.swap(false, Ordering::Relaxed);
    let choice = Choice::new(&problem, found)?;
    interrupted |= stop.load(Ordering::Relaxed);
    let changes = changes(experiment, &choice.settings, hand.pivot)?;
    let mut page = page(experiment, options, &changes);
    page.runs = found.map_or(0, |found| found.runs);
    page.by_search = choice.origin == Origin::Search;
    if let Some([before, by_rules, after]) = &choice.predictions {
        page.draws = PREDICTED;
        page.successes = [before, by_rules, after].map(Prediction::successes);
        page.claims = claim_rows(before, after);
        page.costs = cost_rows(&uncertainty, after);
    }
    Ok(Tuned {
        experiment: tuned(experiment, &changes, choice.origin)?,
        page,
        interrupted,
    })
}

/// The better of the settings by the rules and by the search.
struct Choice {
    settings: Settings,
    origin: Origin,
    /// Predictions for the experiment's own settings, for the rules and for the chosen settings; `None` if interrupted.
    predictions: Option<[Prediction; 3]>,
}

impl Choice {
    /// Chooses between the rules and the settings `found` by a search by their predicted scores. If the predictions
    /// were interrupted, chooses the search.
    fn new(problem: &Problem<'_>, found: Option<Found>) -> Result<Self, TuneError> {
        let rules = problem.settings(&[0.0; SETTINGS]);
        let candidate = found.map_or(rules, |found| found.settings);
        let predict = |settings: Option<&Settings>| Prediction::new(problem, settings, PREDICTED);
        let predicted = [None, Some(&rules), Some(&candidate)].map(predict);
        let [before, by_rules, by_search] = predicted;
        let predictions = (before?.zip(by_rules?).zip(by_search?))
            .map(|((before, by_rules), by_search)| [before, by_rules, by_search]);
        let is_better =
            |[_, by_rules, by_search]: &[Prediction; 3]| by_search.score() > by_rules.score();
        if found.is_some() && predictions.as_ref().is_none_or(is_better) {
            return Ok(Self {
                settings: candidate,
                origin: Origin::Search,
                predictions,
            });
        }
        Ok(Self {
            settings: rules,
            origin: Origin::Rules,
            predictions: predictions
                .map(|[before, by_rules, _]| [before, by_rules.clone(), by_rules]),
        })
    }
}

/// Creates a page without predictions.
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

/// Uncertain values, sorted by how much the success rate differs between their thirds.
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
