//! The `feeler compare` subcommand.

pub mod arguments;
pub mod laws;

use super::compare_grips::compare_grips;
use super::contenders::{Contender, close, contenders, run, under_law};
use crate::{CommandError, Outcome};
pub use arguments::Arguments;
use arguments::PAGE;
use feeler::control::law::LawConfig;
use feeler::control::task::TaskConfig;
use feeler_lab::config::{Experiment, ExperimentConfig};
use feeler_lab::sweep::Plan;
use feeler_lab::sweep::analysis::{Candidate, Goal, compare as compare_laws};
use feeler_lab::sweep::results::write_whole;
use feeler_lab::sweep::trial::Trials;
use feeler_report::pages::{ComparePage, compare_page, number};
use std::io::Write;

pub fn compare(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let settings = [
        &arguments.trial.settings[..],
        &[format!("sensing={}", arguments.sensing)],
    ];
    let experiment = Experiment::load(&arguments.experiment, &settings.concat())?;
    match experiment.config.task {
        TaskConfig::Grip(_) => compare_grips(arguments, &experiment, out),
        _ if arguments.drives.is_some() => {
            Err("--drives: expected an experiment with task.grip".into())
        }
        _ if arguments.least_grip => {
            Err("--least-grip: expected an experiment with task.grip".into())
        }
        _ => compare_caps(arguments, out),
    }
}

/// Compares control laws that close a cap.
fn compare_caps(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let goal = goal(arguments)?;
    let (vary, settings) = draws(arguments)?;
    let names = match &arguments.laws[..] {
        [] => LawConfig::NAMES.map(String::from).to_vec(),
        names => names.to_vec(),
    };
    let mut plans = Vec::new();
    for (name, law) in laws::laws(&names, &arguments.policies)? {
        let (law, trials) = plan(arguments, law, &vary, &settings)?;
        plans.push((name, law, trials));
    }
    let mut contenders = contenders(&arguments.trial, &arguments.out, plans)?;
    let ended = run(&arguments.trial, &mut contenders)?;
    let page = page(arguments, &contenders, goal);
    let finished = page.trials;
    if finished > 0 {
        let path = arguments.out.join(PAGE);
        write_whole(&path, compare_page(&page).as_bytes())?;
        print(&page, out)?;
        writeln!(out, "{}", path.display())?;
    }
    close(contenders, ended, finished, out)
}

fn goal(arguments: &Arguments) -> Result<Goal, CommandError> {
    let (torque, force) = (arguments.goal_torque, arguments.goal_force);
    for (name, value) in [("--goal-torque", torque), ("--goal-force", force)] {
        if !(value > 0.0 && value <= 1e9) {
            return Err(format!("{name} {value}: expected more than 0, at most 1e9").into());
        }
    }
    Ok(Goal { torque, force })
}

/// Returns the varied parameters, and the settings that they require.
fn draws(arguments: &Arguments) -> Result<(Vec<String>, Vec<String>), CommandError> {
    let mut settings = arguments.trial.settings.clone();
    settings.push(format!("sensing={}", arguments.sensing));
    let config = Experiment::load(&arguments.experiment, &settings)?.config;
    if !config.task.takes_law() {
        let (name, task) = (&arguments.experiment, config.task.name());
        return Err(format!(
            "{name}: task.{task} controls contact forces itself, so control laws have no effect; expected an experiment with {}",
            TaskConfig::WITH_LAW
        )
        .into());
    }
    let Some((cap, object, thread)) = config.simulation()?.cap() else {
        let name = &arguments.experiment;
        return Err(format!(
            "{name}: no object is on a thread; expected an experiment that closes a cap"
        )
        .into());
    };
    if !arguments.vary.is_empty() {
        return Ok((arguments.vary.clone(), settings));
    }
    let object_key = format!("sim.object.{cap}");
    // The drawn friction must be the true one, and the offset must exist to be varied.
    settings.push("sim.variation.friction=0.0".to_string());
    settings.push(format!("{object_key}.offset={:?}", object.offset));
    let seat = thread.seat_angle;
    let vary = [
        "friction=uniform(0.4,1.2)".to_string(),
        format!("{object_key}.offset.0=uniform(-0.001,0.001)"),
        format!("{object_key}.offset.1=uniform(-0.001,0.001)"),
        format!(
            "{object_key}.motion.thread.seat_angle=uniform({:?},{:?})",
            0.5 * seat,
            1.5 * seat
        ),
    ];
    Ok((vary.into_iter().chain(noise(&config)?).collect(), settings))
}

/// Returns the sensing noise parameters, varied from 0 to three times the experiment's values.
fn noise(config: &ExperimentConfig) -> Result<[String; 2], CommandError> {
    let noise = &config.simulation()?.direct_sensing;
    let vary =
        |name: &str, value: f64| format!("direct_sensing.{name}=uniform(0,{:?})", 3.0 * value);
    Ok([
        vary("normal_noise", noise.normal_noise),
        vary("shear_noise", noise.shear_noise),
    ])
}

/// Returns the trials of one law.
fn plan(
    arguments: &Arguments,
    law: LawConfig,
    vary: &[String],
    settings: &[String],
) -> Result<(LawConfig, Trials), CommandError> {
    let name = &arguments.experiment;
    let experiment = under_law(name, settings, &law)?;
    let law = experiment.config.control.law.clone();
    let plan = Plan::new(
        &experiment,
        name,
        vary,
        arguments.trial.seed,
        arguments.trials,
    )?;
    Ok((law, Trials::new(&plan)?))
}

fn page(arguments: &Arguments, contenders: &[Contender], goal: Goal) -> ComparePage {
    let candidates: Vec<_> = contenders
        .iter()
        .map(|contender| Candidate {
            name: &contender.name,
            law: contender.law.clone(),
            table: &contender.store.table,
        })
        .collect();
    let first = contenders.first().map(|contender| &contender.trials);
    let against = first.and_then(|trials| trials.parameters().first());
    let vary = first.map_or(&[][..], |trials| &trials.plan().vary);
    let vary: String = vary.iter().map(|v| format!(" --vary '{v}'")).collect();
    ComparePage {
        name: arguments.experiment.clone(),
        planned: arguments.trials,
        varied: format!("--seed {}{vary}", arguments.trial.seed),
        experiment: first.map_or_else(String::new, |trials| trials.plan().experiment.clone()),
        ..compare_laws(
            &candidates,
            goal,
            against.map(|parameter| parameter.name.as_str()),
        )
    }
}

/// Prints the report's table.
fn print(page: &ComparePage, out: &mut dyn Write) -> std::io::Result<()> {
    for law in &page.laws {
        match law.lines {
            Some(lines) => writeln!(out, "{} ({lines} lines of code)", law.name)?,
            None => writeln!(out, "{}", law.name)?,
        }
        for row in &law.rows {
            let value = row.value.map_or_else(|| "-".to_string(), number);
            writeln!(out, "  {:<24} {value}", row.name)?;
        }
    }
    for verdict in (1..page.laws.len()).filter_map(|law| page.verdict(law)) {
        writeln!(out, "{verdict}")?;
    }
    Ok(())
}
