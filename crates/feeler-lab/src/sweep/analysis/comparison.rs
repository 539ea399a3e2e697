//! Comparison of control laws on the same trials, from the tables of the laws to the comparison page.
//!
//! Trial `k` draws the same values under each law. Differences between laws are therefore computed per trial, which
//! eliminates the variation between trials.

use super::interval::{Estimate, bootstrap};
use crate::sweep::results::table::Table;
use feeler::control::law::LawConfig;
use feeler_report::figures::sweep::wilson;
use feeler_report::pages::{ComparePage, ComparedLaw, Curve, Curves, PairedMeasure, Pairs, Row};

/// Number of bins of the curves over a parameter.
const BINS: usize = 8;
/// Strokes in which the fingers follow a cap that is closed.
const CLOSED: [u32; 2] = [3, 4];

/// Success criterion of a trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Minimum final torque of the cap (N·m).
    pub torque: f64,
    /// Maximum force on any element (N).
    pub force: f64,
}

/// A law with its trials.
pub struct Candidate<'a> {
    /// Displayed name.
    pub name: &'a str,
    /// Configuration of the law.
    pub law: LawConfig,
    /// Table of its trials.
    pub table: &'a Table,
}

/// Evaluation of one trial.
#[derive(Debug, Clone, Copy)]
struct Result {
    success: bool,
    /// Values in the order of [`MEASURES`].
    measures: [Option<f64>; MEASURES.len()],
}

/// Name with unit, and the function that extracts the value.
type Measure = (&'static str, fn(&Fields<'_>) -> Option<f64>);

/// Quantities compared for each trial. The first two decide which law is better.
const MEASURES: [Measure; 7] = [
    ("final torque (mN·m)", |f| {
        Some(1e3 * f.number("cap_torque")?)
    }),
    ("peak element force (N)", |f| {
        f.strokes("peak_element_force").reduce(f64::max)
    }),
    ("work lost in slip (mJ)", |f| {
        Some(1e3 * f.number("slip_work")?)
    }),
    ("distance to axis, std (mm)", |f| {
        Some(1e3 * f.closed("path_radius_std")?)
    }),
    ("curvature relative to the arc", |f| {
        f.closed("path_curvature")
    }),
    ("grip variation", |f| f.closed("grasp_force_variation")),
    ("time to the end (s)", |f| f.number("sim_time")),
];

/// Access to the fields of a row by column name.
struct Fields<'a> {
    table: &'a Table,
    row: &'a [String],
}

impl Fields<'_> {
    fn text(&self, name: &str) -> &str {
        let column = self.table.column(name);
        column
            .and_then(|c| self.row.get(c))
            .map_or("", String::as_str)
    }

    fn number(&self, name: &str) -> Option<f64> {
        self.text(name).parse().ok()
    }

    /// Values of a stroke measure for all strokes of the trial.
    fn strokes(&self, name: &str) -> impl Iterator<Item = f64> {
        let columns = (1..).map(move |stroke| format!("stroke{stroke}.{name}"));
        let columns = columns.take_while(|column| self.table.column(column).is_some());
        columns.filter_map(|column| self.number(&column))
    }

    /// Mean of a stroke measure over those of the strokes [`CLOSED`] that were made. `None` if there is no value.
    fn closed(&self, name: &str) -> Option<f64> {
        let strokes = CLOSED.map(|stroke| self.number(&format!("stroke{stroke}.{name}")));
        let made: Vec<_> = strokes.into_iter().flatten().collect();
        (!made.is_empty()).then(|| made.iter().sum::<f64>() / made.len() as f64)
    }

    fn result(&self, goal: Goal) -> Result {
        let measures = MEASURES.map(|(_, measure)| measure(self));
        let tight = measures[0].is_some_and(|torque| torque >= 1e3 * goal.torque);
        let whole = measures[1].is_some_and(|force| force <= goal.force);
        Result {
            success: self.text("outcome") == "done" && tight && whole,
            measures,
        }
    }
}

/// Builds the comparison page from the trials that all `candidates` have finished. Differences are relative to the
/// first candidate. The curves are plotted over the parameter `against`.
pub fn compare(candidates: &[Candidate<'_>], goal: Goal, against: Option<&str>) -> ComparePage {
    let tables = candidates.iter().map(|candidate| candidate.table);
    let trials: Vec<u64> = Table::common(tables).into_iter().collect();
    let results: Vec<Vec<Result>> = candidates
        .iter()
        .map(|candidate| {
            let rows = trials.iter().map(|trial| &candidate.table.rows[trial]);
            let table = candidate.table;
            rows.map(|row| Fields { table, row }.result(goal)).collect()
        })
        .collect();
    let laws = candidates.iter().zip(&results);
    ComparePage {
        trials: trials.len() as u64,
        goal: (1e3 * goal.torque, goal.force),
        laws: laws
            .map(|(candidate, own)| compared(candidate, own, &results[0]))
            .collect(),
        curves: against.map_or_else(Vec::new, |name| curves(candidates, &trials, &results, name)),
        pairs: pairs(candidates, &trials, &results),
        ..ComparePage::default()
    }
}

fn compared(candidate: &Candidate<'_>, own: &[Result], first: &[Result]) -> ComparedLaw {
    let share = |results: &[Result]| -> Vec<f64> {
        results
            .iter()
            .map(|r| 100.0 * f64::from(u8::from(r.success)))
            .collect()
    };
    let mut rows = vec![Row {
        name: "success (%)",
        value: rate(own),
        difference: difference(&share(own), &share(first)),
    }];
    for (index, (name, _)) in MEASURES.iter().enumerate() {
        let pairs = own.iter().zip(first);
        let pairs = pairs.filter_map(|(a, b)| Some((a.measures[index]?, b.measures[index]?)));
        let (ours, theirs): (Vec<_>, Vec<_>) = pairs.unzip();
        let all: Vec<_> = own.iter().filter_map(|r| r.measures[index]).collect();
        rows.push(Row {
            name,
            value: estimate(&all),
            difference: difference(&ours, &theirs),
        });
    }
    ComparedLaw {
        name: candidate.name.to_string(),
        lines: candidate.law.source().map(lines_of_code),
        rows,
    }
}

/// Success rate (%) with its Wilson interval.
fn rate(results: &[Result]) -> Option<[f64; 3]> {
    let (trials, successes) = (results.len(), results.iter().filter(|r| r.success).count());
    let (low, high) = wilson(successes as u64, trials as u64);
    let share = successes as f64 / trials as f64;
    (trials > 0).then(|| [low, share, high].map(|part| 100.0 * part))
}

fn difference(ours: &[f64], theirs: &[f64]) -> Option<[f64; 3]> {
    let pairs = ours.iter().zip(theirs);
    estimate(&pairs.map(|(a, b)| a - b).collect::<Vec<_>>())
}

/// Mean with the ends of its interval, which are NaN for a single value.
fn estimate(values: &[f64]) -> Option<[f64; 3]> {
    bootstrap(values).map(|estimate| estimate.with_ends(values.len()))
}

fn ends(estimate: Estimate) -> [f64; 3] {
    [estimate.low, estimate.mean, estimate.high]
}

/// Pairs the trials of each other law with those of the first law, for the measures that decide which law is better.
fn pairs(candidates: &[Candidate<'_>], trials: &[u64], results: &[Vec<Result>]) -> Vec<Pairs> {
    const JUDGED: usize = 2;
    let laws = candidates.iter().zip(results).skip(1);
    let paired = laws.map(|(other, own)| {
        let measures = MEASURES[..JUDGED].iter().enumerate();
        let measures = measures.map(|(index, (name, _))| {
            let both = trials.iter().zip(&results[0]).zip(own);
            let both = both.filter_map(|((&trial, first), other)| {
                Some((trial, first.measures[index]?, other.measures[index]?))
            });
            PairedMeasure {
                name,
                trials: both.collect(),
            }
        });
        Pairs {
            first: candidates[0].name.to_string(),
            other: other.name.to_string(),
            measures: measures.collect(),
        }
    });
    paired.collect()
}

/// Curves of the success rate and of each measure over a parameter.
fn curves(
    candidates: &[Candidate<'_>],
    trials: &[u64],
    results: &[Vec<Result>],
    name: &str,
) -> Vec<Curves> {
    let Some(table) = candidates.first().map(|c| c.table) else {
        return Vec::new();
    };
    let value = |trial: &u64| {
        Fields {
            table,
            row: &table.rows[trial],
        }
        .number(name)
    };
    let Some(x) = trials.iter().map(value).collect::<Option<Vec<f64>>>() else {
        return Vec::new();
    };
    let low = x.iter().copied().fold(f64::INFINITY, f64::min);
    let width = (x.iter().copied().fold(low, f64::max) - low) / BINS as f64;
    let bin = |x: f64| (((x - low) / width) as usize).min(BINS - 1);
    let draw = |title: &str, point: &dyn Fn(&[Result]) -> Option<[f64; 3]>| {
        let curves = candidates.iter().zip(results).map(|(candidate, own)| {
            let points = (0..BINS).filter_map(|wanted| {
                let inside = x.iter().zip(own).filter(|(x, _)| bin(**x) == wanted);
                let inside: Vec<_> = inside.map(|(_, result)| *result).collect();
                Some((low + (wanted as f64 + 0.5) * width, point(&inside)?))
            });
            Curve {
                law: candidate.name.to_string(),
                points: points.collect(),
            }
        });
        Curves {
            title: title.to_string(),
            against: name.to_string(),
            curves: curves.collect(),
        }
    };
    let mut curves = vec![draw("success (%)", &rate)];
    for (index, (title, _)) in MEASURES.iter().enumerate() {
        curves.push(draw(title, &|inside: &[Result]| {
            let values: Vec<_> = inside.iter().filter_map(|r| r.measures[index]).collect();
            bootstrap(&values).map(ends)
        }));
    }
    // Omit measures without values, such as those of a third stroke that was never made.
    curves.retain(|drawn| drawn.curves.iter().any(|curve| !curve.points.is_empty()));
    curves
}

/// Counts the lines of a source that are neither blank nor comments.
fn lines_of_code(source: &str) -> usize {
    let code = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
    source.lines().filter(code).count()
}
