//! `feeler compare` of a gripper: laws of the grip force on the same unknown objects.

use super::compare::arguments::{Arguments, PAGE};
use super::compare::laws;
use super::trials::{in_parallel, trial_seed};
use crate::{CommandError, Outcome, emulated};
use feeler::control::law::LawConfig;
use feeler::control::task::TaskConfig;
use feeler::control::task::grip::GripLaw;
use feeler_console::{Outputs, Steps, watch_for_interrupt};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Pictures, Session};
use feeler_lab::grips::{GripDifference, GripRow, GripScore, GripTrial, grip_over_load};
use feeler_report::pages::{GRIP_COLUMNS, GripsPage, grips_page, significant};
use feeler_report::run::create_folder;
use std::collections::BTreeMap;
use std::io::Write;

/// Rows of each law, in the order of the laws.
type Results = Vec<(String, Vec<GripRow>)>;

/// Name of a law or policy, and the experiment that uses it.
type Contender = (String, Experiment);

/// Runs the comparison.
pub fn compare_grips(
    arguments: &Arguments,
    experiment: &Experiment,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let contenders = contenders(arguments, experiment)?;
    create_folder(&arguments.out)
        .map_err(|e| format!("--out {}: {e}; expected a folder", arguments.out.display()))?;
    let mut outputs = Outputs::without_force("another folder");
    let page_file = outputs.create(&arguments.out.join(PAGE), "--out")?;
    let mut tables = Vec::new();
    for (name, _) in &contenders {
        let path = arguments.out.join(format!("{name}.csv"));
        tables.push(outputs.create(&path, "--out")?);
    }
    let (results, whole) = run(arguments, &contenders)?;
    for ((_, rows), table) in results.iter().zip(tables) {
        let lines = rows.iter().map(|row| row.fields() + "\n");
        let text = format!("{}\n{}", GripRow::HEADER, lines.collect::<String>());
        match whole {
            true => table.finish(text.as_bytes())?,
            false => table.writer()?.write_all(text.as_bytes())?,
        }
    }
    let page = page(arguments, &results);
    print(&page, out)?;
    if !whole {
        writeln!(
            out,
            "interrupted after {} of {} objects; their rows are in {}/*.csv.part",
            page.trials,
            arguments.trials,
            arguments.out.display()
        )?;
        return Ok(Outcome::GivenUp);
    }
    page_file.finish(grips_page(&page).as_bytes())?;
    writeln!(out, "{}", arguments.out.join(PAGE).display())?;
    Ok(Outcome::Done)
}

/// Returns the requested laws of the task: by default all, or only the policies if any are given.
fn grip_laws(arguments: &Arguments) -> Result<Vec<GripLaw>, CommandError> {
    if arguments.trial.resume {
        return Err("--resume: a comparison of grippers cannot be continued".into());
    }
    if !arguments.vary.is_empty() {
        return Err("--vary: a comparison of grippers draws its own objects".into());
    }
    let named = |name: &String| {
        let mut all = GripLaw::ALL.into_iter();
        all.find(|law| law.name() == name).ok_or_else(|| {
            let names = GripLaw::ALL.map(GripLaw::name).join(", ");
            CommandError::from(format!("--laws {name}: expected one of {names}"))
        })
    };
    match &arguments.laws[..] {
        [] if !arguments.policies.is_empty() => Ok(Vec::new()),
        [] => Ok(GripLaw::ALL.to_vec()),
        names => match (1..names.len()).find(|&later| names[..later].contains(&names[later])) {
            Some(later) => Err(format!("--laws: {} is given twice", names[later]).into()),
            None => names.iter().map(named).collect(),
        },
    }
}

/// Returns the name and experiment of each requested law and policy.
fn contenders(
    arguments: &Arguments,
    experiment: &Experiment,
) -> Result<Vec<Contender>, CommandError> {
    let mut contenders = Vec::new();
    for law in grip_laws(arguments)? {
        let mut experiment = experiment.clone();
        if let TaskConfig::Grip(grip) = &mut experiment.config.task {
            grip.law = law;
        }
        contenders.push((law.name().to_string(), experiment));
    }
    for (name, law) in laws::laws(&[], &arguments.policies)? {
        if contenders.iter().any(|(other, _)| *other == name) {
            return Err(
                format!("--policy: the name {name} is that of a law; rename the file").into(),
            );
        }
        contenders.push((name, under_policy(experiment, law)?));
    }
    Ok(contenders)
}

/// Returns the experiment with the policy `law`, which is read from disk once for all trials.
fn under_policy(experiment: &Experiment, law: LawConfig) -> Result<Experiment, CommandError> {
    let mut experiment = experiment.clone();
    experiment.config.control.law = law;
    if let TaskConfig::Grip(grip) = &mut experiment.config.task {
        grip.law = GripLaw::Policy;
    }
    let policy = experiment.policy_file()?;
    let experiment = experiment.with_policy(policy);
    // A policy for another hand is rejected before any trial runs.
    Session::rendering(&experiment, Pictures::Sensed)?;
    Ok(experiment)
}

/// Runs all objects, each with all laws. Returns the rows of the finished objects, and `true` if all objects are
/// finished.
fn run(arguments: &Arguments, contenders: &[Contender]) -> Result<(Results, bool), CommandError> {
    let interrupted = watch_for_interrupt()?;
    let (count, trial) = (arguments.trials, &arguments.trial);
    let bar = Steps::new(count as usize);
    let laws_of = |number: u64| -> Result<Vec<GripRow>, String> {
        let seed = trial_seed(trial.seed, number);
        let least = match (arguments.least_grip, contenders) {
            (true, [(_, experiment), ..]) => {
                GripTrial::least_grip(experiment, seed).map_err(|error| error.to_string())?
            }
            _ => None,
        };
        let row = |(_, experiment): &Contender| {
            let ran = match arguments.drives {
                Some(_) => emulated::grip_trial(experiment, seed),
                None => GripTrial::run(experiment, seed).map_err(|error| error.to_string()),
            };
            Ok(GripRow::new(number, &ran?, least))
        };
        contenders.iter().map(row).collect()
    };
    let mut finished = BTreeMap::new();
    in_parallel(
        count,
        trial.jobs(),
        &interrupted,
        laws_of,
        |number, rows| {
            finished.insert(number, rows?);
            bar.advance();
            Ok::<_, CommandError>(())
        },
    )?;
    drop(bar);
    let rows_of = |law: usize| finished.values().map(|rows| rows[law].clone()).collect();
    let results = contenders.iter().enumerate();
    let results = results.map(|(index, (name, _))| (name.clone(), rows_of(index)));
    Ok((results.collect(), finished.len() as u64 == count))
}

fn page(arguments: &Arguments, results: &Results) -> GripsPage {
    let laws = results
        .iter()
        .map(|(law, rows)| (law.clone(), values(&GripScore::new(rows))));
    GripsPage {
        name: arguments.experiment.clone(),
        trials: results.first().map_or(0, |(_, rows)| rows.len() as u64),
        seed: arguments.trial.seed,
        laws: laws.collect(),
        verdicts: verdicts(results),
        grips: grip_over_load(results),
    }
}

/// Compares each law with the first, object by object.
fn verdicts(results: &Results) -> Vec<String> {
    let Some(((reference, theirs), others)) = results.split_first() else {
        return Vec::new();
    };
    let verdict = |(law, rows): &(String, Vec<GripRow>)| {
        let difference = GripDifference::new(rows, theirs)?;
        let points = |[low, mean, high]: [f64; 3]| {
            let [low, mean, high] = [low, mean, high].map(|share| format!("{:+.1}", 100.0 * share));
            format!("{mean} [{low}, {high}]")
        };
        Some(format!(
            "{law} compared with {reference}, in percentage points: dropped {}; crushed {}; dropped or crushed {}",
            points(difference.dropped),
            points(difference.crushed),
            points(difference.failed)
        ))
    };
    others.iter().filter_map(verdict).collect()
}

/// Formats the figures of a law in the order of [`GRIP_COLUMNS`].
fn values(score: &GripScore) -> [String; 9] {
    let range = |[low, value, high]: [f64; 3], factor: f64| {
        let [low, value, high] = [low, value, high].map(|value| significant(factor * value));
        format!("{value} [{low}, {high}]")
    };
    let missing = || "-".to_string();
    let ratio = |excess: Option<_>| excess.map_or_else(missing, |excess| range(excess, 1.0));
    let milliseconds = |which: usize| {
        let reaction = score.reaction.map(|times| times[which]);
        reaction.map_or_else(missing, |time| match time.is_finite() {
            true => significant(1e3 * time),
            false => "never".to_string(),
        })
    };
    [
        range(score.dropped, 100.0),
        range(score.crushed, 100.0),
        range(score.failed, 100.0),
        ratio(score.excess),
        ratio(score.excess_of_load),
        significant(score.excess_of_sums),
        score.slips.to_string(),
        milliseconds(0),
        milliseconds(1),
    ]
}

fn print(page: &GripsPage, out: &mut dyn Write) -> std::io::Result<()> {
    for (law, values) in &page.laws {
        writeln!(out, "{law}")?;
        for (name, value) in GRIP_COLUMNS.iter().zip(values) {
            writeln!(out, "  {name:<30} {value}")?;
        }
    }
    for verdict in &page.verdicts {
        writeln!(out, "{verdict}")?;
    }
    Ok(())
}
