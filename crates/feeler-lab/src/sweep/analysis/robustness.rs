//! Success rates of plausible hands and sensitivity indices from the table of a designed sweep.
//!
//! A *hand* is a trial whose experiment can be run. A rejected trial (`invalid`: a value out of range, a home position
//! that no finger reaches) is not a hand; it is counted separately and excluded from all rates. A hand that stops,
//! times out or fails is included in every rate, with the claims that its recording passes. Claims that were not
//! measured fail.

use super::interval::Estimate;
use super::sensitivity::{Swap, indices};
use crate::sweep::plan::design::Scheme;
use crate::sweep::plan::distribution::Distribution;
use crate::sweep::results::table::Table;
use crate::sweep::trial::Trials;
use feeler_report::DecidedBy;
use feeler_report::figures::sweep::wilson;
use feeler_report::pages::{
    ALL_OF_HAND, Ending, Index, Measure, NOTHING, RangeRow, RobustnessPage, Share, Trace, Varied,
};
use std::collections::BTreeMap;

/// Margins are clamped to this magnitude: beyond twice the bound, or zero, differences are irrelevant.
const MARGIN: f64 = 1.0;
/// Number of parameters plotted for each measure.
const TRACES: usize = 3;

/// A criterion evaluated for every hand: one claim, or several together.
struct Judged {
    name: String,
    decided_by: Option<DecidedBy>,
    /// Columns of the claims' results, which must all be 1 (pass).
    holds: Vec<usize>,
    /// Columns of margins; the margin of the criterion is the smallest of them.
    margins: Vec<usize>,
}

/// Evaluation of one hand.
#[derive(Debug, Clone, Copy)]
struct Result {
    holds: bool,
    margin: f64,
}

/// Builds the robustness page from the finished trials.
pub fn robustness(trials: &Trials, table: &Table) -> RobustnessPage {
    let plan = trials.plan();
    let Some(scheme) = plan.scheme() else {
        return RobustnessPage::default();
    };
    let judged = judged(trials, table);
    let measures = judged.iter().map(|judged| {
        let result = |trial: u64| judged.of(table, trial);
        measure(judged, trials, table, &scheme, &result)
    });
    let hand = |trial: &u64| table.rows.get(trial).is_some_and(|row| is_hand(table, row));
    RobustnessPage {
        name: plan.origin.clone(),
        seed: plan.seed,
        finished: table.rows.len() as u64,
        planned: plan.trials,
        rows: scheme.rows().end,
        hands: scheme.rows().filter(hand).count() as u64,
        pairs: scheme.swaps(0).count() as u64,
        factors: scheme.factors.iter().map(|f| f.name.clone()).collect(),
        parameters: plan.parameter.len(),
        measures: measures.collect(),
        endings: endings(table, &scheme),
        ranges: ranges(trials),
        experiment: plan.experiment.clone(),
    }
}

/// Returns the claims that a success requires, claims about the hand first, and their combinations.
fn judged(trials: &Trials, table: &Table) -> Vec<Judged> {
    let claims = trials.required_claims().filter_map(|claim| {
        Some(Judged {
            name: claim.id.replace('-', " "),
            decided_by: claim.decided_by,
            holds: vec![table.column(&claim.holds())?],
            margins: vec![table.column(&claim.margin())?],
        })
    });
    let with_bottle = |j: &Judged| j.decided_by == Some(DecidedBy::HandAndBottle);
    let (others, mut judged): (Vec<_>, Vec<_>) = claims.partition(with_bottle);
    if !others.is_empty() {
        judged.push(Judged {
            name: ALL_OF_HAND.to_string(),
            decided_by: Some(DecidedBy::Hand),
            holds: judged.iter().flat_map(|j| j.holds.clone()).collect(),
            margins: judged.iter().flat_map(|j| j.margins.clone()).collect(),
        });
        judged.extend(others);
    }
    if let Some(success) = table.column("success") {
        let name = match judged.is_empty() {
            true => trials.success(),
            false => "all together",
        };
        judged.push(Judged {
            name: name.to_string(),
            decided_by: None,
            holds: vec![success],
            margins: judged.iter().flat_map(|j| j.margins.clone()).collect(),
        });
    }
    judged
}

pub(in crate::sweep) fn is_hand(table: &Table, row: &[String]) -> bool {
    let outcome = table.column("outcome").and_then(|c| row.get(c));
    outcome.is_some_and(|outcome| outcome != "invalid")
}

impl Judged {
    /// Evaluates a trial. `None` if it is not finished or not a hand.
    fn of(&self, table: &Table, trial: u64) -> Option<Result> {
        let row = table.rows.get(&trial).filter(|row| is_hand(table, row))?;
        // A missing measurement counts as the worst margin.
        let margin = |column: &usize| row[*column].parse().unwrap_or(-MARGIN);
        let least = self.margins.iter().map(margin).fold(MARGIN, f64::min);
        Some(Result {
            holds: self.holds.iter().all(|&column| row[column] == "1"),
            margin: least.max(-MARGIN),
        })
    }
}

fn measure(
    judged: &Judged,
    trials: &Trials,
    table: &Table,
    scheme: &Scheme,
    result: &dyn Fn(u64) -> Option<Result>,
) -> Measure {
    let share = |of: &str, block: std::ops::Range<u64>| {
        let hands: Vec<_> = block.filter_map(result).collect();
        let holding = hands.iter().filter(|hand| hand.holds).count();
        share(of, hands.len() as u64, holding as u64)
    };
    let mut shares = vec![share("all varied", scheme.rows())];
    for (index, group) in scheme.groups.iter().enumerate() {
        shares.push(share(&format!("{group} varied"), scheme.only(Some(index))));
    }
    shares.push(share(NOTHING, scheme.only(None)));
    let by = |quantity: fn(Result) -> f64| -> Vec<Index> {
        let factors = 0..scheme.factors.len();
        factors
            .map(|factor| index(scheme, factor, &|t| result(t).map(quantity)))
            .collect()
    };
    let holds = by(|hand| f64::from(u8::from(hand.holds)));
    let margin = match judged.margins.is_empty() {
        true => Vec::new(),
        false => by(|hand| hand.margin),
    };
    Measure {
        traces: traces(&holds, trials, table, scheme, result),
        name: judged.name.clone(),
        decided_by: judged.decided_by,
        shares: shares.into_iter().filter(|share| share.hands > 0).collect(),
        holds,
        margin,
    }
}

pub(in crate::sweep) fn share(of: &str, hands: u64, holding: u64) -> Share {
    let (low, high) = wilson(holding, hands);
    Share {
        of: of.to_string(),
        hands,
        holding,
        share: [low, holding as f64 / hands.max(1) as f64, high],
    }
}

fn index(scheme: &Scheme, factor: usize, value: &dyn Fn(u64) -> Option<f64>) -> Index {
    let swaps = scheme.swaps(factor).filter_map(|[a, b, ab]| {
        Some(Swap {
            a: value(a)?,
            b: value(b)?,
            ab: value(ab)?,
        })
    });
    let found = indices(&swaps.collect::<Vec<_>>());
    let ends = |e: Estimate| [e.low, e.mean, e.high];
    Index {
        factor: scheme.factors[factor].name.clone(),
        first: found.map(|f| ends(f.first)),
        total: found.map(|f| ends(f.total)),
    }
}

/// Returns the parameters with the largest total effects, with their values in all hands.
fn traces(
    holds: &[Index],
    trials: &Trials,
    table: &Table,
    scheme: &Scheme,
    result: &dyn Fn(u64) -> Option<Result>,
) -> Vec<Trace> {
    let mean = |index: &Index| index.total.map_or(0.0, |total| total[1]);
    let alone = trials
        .parameters()
        .iter()
        .zip(&trials.plan().parameter)
        .zip(holds);
    let mut ranked: Vec<_> = alone.filter(|(_, index)| mean(index) > 0.0).collect();
    ranked.sort_by(|a, b| mean(b.1).total_cmp(&mean(a.1)));
    let traces = ranked
        .into_iter()
        .filter_map(|((parameter, entry), index)| {
            let column = table.column(&parameter.name)?;
            let value = |trial: u64| table.rows.get(&trial)?.get(column)?.parse::<f64>().ok();
            let hands = scheme
                .rows()
                .filter_map(|trial| Some((value(trial)?, result(trial)?.holds)));
            Some(Trace {
                varied: Varied {
                    name: with_unit(&parameter.name, &entry.unit),
                    logarithmic: matches!(parameter.distribution, Distribution::LogUniform(..)),
                    trials: hands.collect(),
                },
                total: index.total?[1],
                nominal: parameter.nominal.parse().ok(),
            })
        });
    traces.take(TRACES).collect()
}

fn with_unit(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_string(),
        unit => format!("{name} ({unit})"),
    }
}

/// Counts the outcomes of the trials that vary all parameters, each with an example of the reason.
fn endings(table: &Table, scheme: &Scheme) -> Vec<Ending> {
    let (Some(outcome), Some(reason)) = (table.column("outcome"), table.column("reason")) else {
        return Vec::new();
    };
    // Reasons that differ only in numbers are merged.
    let kind = |reason: &str| {
        let letters: String = reason.chars().filter(|c| !c.is_ascii_digit()).collect();
        letters
            .split_whitespace()
            .take(8)
            .collect::<Vec<_>>()
            .join(" ")
    };
    let mut counts: BTreeMap<(String, String), (u64, String)> = BTreeMap::new();
    for row in scheme.rows().filter_map(|trial| table.rows.get(&trial)) {
        let entry = counts.entry((row[outcome].clone(), kind(&row[reason])));
        entry.or_insert_with(|| (0, row[reason].clone())).0 += 1;
    }
    let mut endings: Vec<_> = (counts.into_iter())
        .map(|((outcome, _), (trials, reason))| Ending {
            outcome,
            trials,
            reason,
        })
        .collect();
    endings.sort_by_key(|ending| std::cmp::Reverse(ending.trials));
    endings
}

pub(in crate::sweep) fn ranges(trials: &Trials) -> Vec<RangeRow> {
    let entries = trials.plan().parameter.iter().zip(trials.parameters());
    let rows = entries.map(|(entry, parameter)| {
        let ends = parameter.distribution.extremes(parameter.whole);
        let keys = entry
            .key
            .iter()
            .chain(entry.keys.iter().map(|link| &link.key));
        RangeRow {
            name: entry.name.clone(),
            group: entry.group.clone(),
            unit: entry.unit.clone(),
            keys: keys.cloned().collect(),
            of: entry.of.clone(),
            power: entry.power,
            range: entry.range.clone(),
            ends,
            nominal: parameter.nominal.clone(),
            why: entry.why.clone(),
        }
    });
    rows.collect()
}
