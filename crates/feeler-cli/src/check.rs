//! `feeler check`

use super::{CommandError, Outcome};
use crate::options::Json;
use feeler_console::print_json;
use feeler_lab::config::{ConfigError, Experiment};
use feeler_lab::experiment::warnings::warnings;
use feeler_lab::experiment::{Session, check_rig};
use serde::Serialize;
use std::error::Error;
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// An experiment file, or the name of a built-in experiment.
    experiment: String,
    /// Check it with this value set, as in control.slip_threshold=2.5.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    #[command(flatten)]
    json: Json,
}

/// What `--json` prints.
#[derive(Default, Serialize)]
struct Checked {
    /// The experiment as named.
    experiment: String,
    good: bool,
    /// What is wrong with it.
    problems: Vec<String>,
    warnings: Vec<String>,
    /// Its own name.
    name: String,
    /// Elements of each finger.
    elements: Vec<usize>,
    strokes: u32,
    /// Whether it has a simulated world.
    simulated: bool,
}

pub fn check(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let mut checked = Checked {
        experiment: arguments.experiment.clone(),
        ..Checked::default()
    };
    let found = look(arguments, &mut checked);
    if arguments.json.json {
        if let Err(error) = &found {
            checked.problems = problems(&**error);
        }
        checked.good = found.is_ok();
        print_json(&checked, out)?;
    } else {
        // Before what may be refused for the same mistake.
        for warning in &checked.warnings {
            writeln!(out, "warning: {warning}")?;
        }
    }
    found?;
    if !arguments.json.json {
        let rig = match checked.simulated {
            true => "",
            false => "; a real rig, as there is no [sim]",
        };
        writeln!(
            out,
            "{}: good ({}; {} fingers of {} elements, {} strokes{rig})",
            checked.experiment,
            checked.name,
            checked.elements.len(),
            elements(&checked.elements),
            checked.strokes,
        )?;
    }
    Ok(Outcome::Done)
}

/// Writes what is found into `checked`.
fn look(arguments: &Arguments, checked: &mut Checked) -> Result<(), CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &arguments.settings)?;
    checked.warnings = warnings(&experiment)
        .iter()
        .map(ToString::to_string)
        .collect();
    let config = &experiment.config;
    checked.name.clone_from(&config.name);
    checked.strokes = config.task.strokes();
    checked.simulated = config.sim.is_some();
    // Building everything checks what only the whole can tell: reach, sight, calibration.
    let layouts = match config.sim {
        Some(_) => Session::new(&experiment)?.layouts().to_vec(),
        None => check_rig(&experiment)?,
    };
    checked.elements = layouts.iter().map(|layout| layout.elements.len()).collect();
    Ok(())
}

/// What is wrong: every value that is out of range, or the one thing that ended the check.
fn problems(error: &(dyn Error + 'static)) -> Vec<String> {
    match error.downcast_ref::<ConfigError>() {
        Some(ConfigError::OutOfRange { problems, .. }) => {
            problems.iter().map(ToString::to_string).collect()
        }
        _ => vec![error.to_string()],
    }
}

/// How many elements the fingers have: one number, or one for each where they differ.
fn elements(counts: &[usize]) -> String {
    let mut counts: Vec<_> = counts.iter().map(ToString::to_string).collect();
    if counts.iter().all(|count| *count == counts[0]) {
        counts.truncate(1);
    }
    counts.join(", ")
}
