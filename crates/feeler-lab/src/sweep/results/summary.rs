//! Summary page of a sweep.

use super::store::{SUMMARY_PAGE, write_whole};
use super::table::Table;
use crate::sweep::SweepError;
use crate::sweep::plan::distribution::Distribution;
use crate::sweep::trial::Trials;
use feeler_report::pages::{
    Counted, Measured, SweepPage, TrialMeasure, Varied, significant, sweep_page,
};
use std::collections::BTreeMap;
use std::path::Path;

/// Maximum number of failed trials listed.
const WORST: usize = 20;

/// Measures shown on the page: column, name with unit, and factor to that unit.
const SHOWN: [(&str, &str, f64); 4] = [
    ("peak_torque", "peak torque (mN·m)", 1e3),
    ("mean_grasp_force", "mean grasp force (N)", 1.0),
    ("path_inward_bend", "inward bend (mm)", 1e3),
    ("peak_element_force", "peak element force (N)", 1.0),
];

/// Writes the summary page of a sweep into its folder.
///
/// # Errors
/// If it cannot be written.
pub fn write(folder: &Path, trials: &Trials, table: &Table) -> Result<(), SweepError> {
    let page = sweep_page(&page(trials, table));
    write_whole(&folder.join(SUMMARY_PAGE), page.as_bytes())
}

fn page(trials: &Trials, table: &Table) -> SweepPage {
    let plan = trials.plan();
    let (mut numbers, mut words) = (Vec::new(), Vec::new());
    for parameter in trials.parameters() {
        let values: Vec<_> = column(table, &parameter.name)
            .zip(column(table, "success"))
            .collect();
        let parsed: Option<Vec<_>> = (values.iter())
            .map(|(value, success)| Some((value.parse::<f64>().ok()?, *success == "1")))
            .collect();
        match parsed {
            Some(trials) if !matches!(parameter.distribution, Distribution::Choice(_)) => {
                numbers.push(Varied {
                    name: parameter.name.clone(),
                    logarithmic: matches!(parameter.distribution, Distribution::LogUniform(..)),
                    trials,
                });
            }
            _ => words.push((parameter.name.clone(), count(values.into_iter()))),
        }
    }
    // The task's finding is more informative than the bare outcome.
    let told = match table.column("found") {
        Some(_) => "found",
        None => "outcome",
    };
    let outcomes = count(column(table, told).map(|outcome| (outcome, "0")));
    let (worst_header, worst) = worst(trials, table);
    SweepPage {
        name: plan.origin.clone(),
        success: trials.success(),
        counts: table.successes(),
        outcomes: outcomes
            .into_iter()
            .map(|(name, trials, _)| (name, trials))
            .collect(),
        claims: claims(table),
        numbers,
        words,
        measured: measured(table),
        measures: measures(table),
        worst_header,
        worst,
        varied: format!("--seed {} {}", plan.seed, vary(&plan.vary)),
        experiment: plan.experiment.clone(),
    }
}

/// Returns the most informative quantity of each trial: the final torque of a cap, else a finding of the task, else
/// the duration.
fn measured(table: &Table) -> Option<TrialMeasure> {
    const TORQUE: &str = "cap_torque";
    let found = table
        .header
        .iter()
        .filter(|name| name.starts_with("found."));
    let candidates = std::iter::once(TORQUE).chain(found.map(String::as_str));
    candidates.chain(["sim_time"]).find_map(|name| {
        let index = table.column(name)?;
        let (title, factor) = match name {
            TORQUE => ("final torque (mN·m)".to_string(), 1e3),
            "sim_time" => ("time on record (s)".to_string(), 1.0),
            found => (found.replacen("found.", "", 1), 1.0),
        };
        let value = |row: &Vec<String>| Some(factor * row.get(index)?.parse::<f64>().ok()?);
        let trials: Vec<_> = (table.rows.iter())
            .map(|(&trial, row)| (trial, value(row)))
            .collect();
        let is_known = trials.iter().any(|(_, value)| value.is_some());
        is_known.then_some(TrialMeasure {
            name: title,
            trials,
        })
    })
}

fn vary(expressions: &[String]) -> String {
    let options: Vec<_> = expressions
        .iter()
        .map(|e| format!("--vary '{e}'"))
        .collect();
    options.join(" ")
}

fn column<'a>(table: &'a Table, name: &str) -> impl Iterator<Item = &'a str> + use<'a> {
    let column = table.column(name);
    let rows = table.rows.values();
    rows.filter_map(move |row| row.get(column?).map(String::as_str))
}

/// Counts the trials and successes for each distinct value. Each pair contains the value and the success field of a
/// trial, which is `"1"` for a success.
fn count<'a>(values: impl Iterator<Item = (&'a str, &'a str)>) -> Vec<Counted> {
    let mut counts: BTreeMap<&str, (u64, u64)> = BTreeMap::new();
    for (value, success) in values {
        let (trials, successes) = counts.entry(value).or_default();
        *trials += 1;
        *successes += u64::from(success == "1");
    }
    let counts = counts.into_iter();
    counts
        .map(|(value, (trials, successes))| (value.to_string(), trials, successes))
        .collect()
}

/// Returns the result columns of claims with the claim's id, except for claims that apply to no trial. Other columns
/// of a claim have a dot after the id.
fn claim_columns(table: &Table) -> impl Iterator<Item = (&str, &str)> {
    let columns = table.header.iter();
    let claims = columns.filter_map(|name| Some((name.as_str(), name.strip_prefix("claim.")?)));
    let claims = claims.filter(|(_, id)| !id.contains('.'));
    claims.filter(|(name, _)| table.rows.is_empty() || column(table, name).any(|c| !c.is_empty()))
}

fn claims(table: &Table) -> Vec<Counted> {
    claim_columns(table)
        .map(|(name, id)| {
            let held = column(table, name).filter(|&holds| holds == "1").count();
            // The claim does not apply to a trial under another control law, whose field is empty.
            let ran = column(table, "sim_time").map(|time| !time.is_empty());
            let about = column(table, name).zip(ran);
            let trials = about.filter(|(holds, ran)| !(holds.is_empty() && *ran));
            (id.to_string(), trials.count() as u64, held as u64)
        })
        .collect()
}

/// Returns the findings of the task, and the measures of the first and the last stroke.
fn measures(table: &Table) -> Vec<Measured> {
    let numbers = |name: &str| {
        let values = column(table, name).filter_map(|text| text.parse::<f64>().ok());
        values.collect::<Vec<_>>()
    };
    let found = table
        .header
        .iter()
        .filter(|name| name.starts_with("found."));
    let mut measured: Vec<_> = found
        .map(|name| Measured {
            name: name.clone(),
            values: numbers(name),
        })
        .collect();
    if table.column("stroke1.peak_torque").is_none() {
        return measured;
    }
    let strokes = (1..).take_while(|s| table.column(&format!("stroke{s}.peak_torque")).is_some());
    let last = strokes.last().unwrap_or(1);
    let strokes = if last > 1 { vec![1, last] } else { vec![1] };
    for (name, title, factor) in SHOWN {
        for stroke in &strokes {
            let name = format!("stroke{stroke}.{name}");
            let values = numbers(&name).into_iter();
            measured.push(Measured {
                name: format!("{stroke}: {title}"),
                values: values.map(|value| factor * value).collect(),
            });
        }
    }
    measured
}

/// Returns the failed trials, worst first.
fn worst(trials: &Trials, table: &Table) -> (Vec<String>, Vec<Vec<String>>) {
    let mut names = vec!["trial".to_string()];
    names.extend(trials.parameters().iter().map(|p| p.name.clone()));
    names.extend(["outcome", "reason", "claims_held"].map(String::from));
    let columns: Vec<_> = names.iter().filter_map(|name| table.column(name)).collect();
    let (outcome, held) = (table.column("outcome"), table.column("claims_held"));
    let success = table.column("success");
    let field =
        |row: &[String], column: Option<usize>| column.map_or(String::new(), |c| row[c].clone());
    let rank = |row: &[String]| {
        let order = ["error", "invalid", "stopped", "time_limit", "done"];
        let outcome = field(row, outcome);
        let place = order.iter().position(|o| *o == outcome);
        (place, field(row, held).parse::<u32>().unwrap_or(0))
    };
    let mut rows: Vec<_> = table
        .rows
        .values()
        .filter(|row| field(row, success) != "1")
        .collect();
    rows.sort_by_key(|row| rank(row));
    let rows = rows.into_iter().take(WORST);
    let rows = rows.map(|row| columns.iter().map(|&c| shown(&row[c])).collect());
    (names, rows.collect())
}

/// Formats a field for the page, with numbers rounded to significant digits.
fn shown(field: &str) -> String {
    match field.parse::<f64>() {
        Ok(number) if number.is_finite() => significant(number),
        _ => field.to_string(),
    }
}
