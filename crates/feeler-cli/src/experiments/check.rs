//! The `feeler check` subcommand.

use crate::options::Json;
use crate::{CommandError, Outcome};
use feeler_console::print_json;
use feeler_lab::config::{ConfigError, Experiment};
use feeler_lab::experiment::{Session, check_rig, check_shared_servos, warnings};
use serde::Serialize;
use std::error::Error;
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file or name of a built-in experiment.
    experiment: String,
    /// Override an experiment value, e.g. control.slip_threshold=2.5.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
    #[command(flatten)]
    json: Json,
}

/// Output of `--json`.
#[derive(Default, Serialize)]
struct Checked {
    /// The experiment, as given on the command line.
    experiment: String,
    good: bool,
    /// Errors found.
    problems: Vec<String>,
    warnings: Vec<String>,
    /// Name of the experiment.
    name: String,
    /// Number of elements of each finger.
    elements: Vec<usize>,
    strokes: u32,
    /// `true` if the experiment has a simulated world.
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
        // Printed before an error that may have the same cause.
        for warning in &checked.warnings {
            writeln!(out, "warning: {warning}")?;
        }
    }
    found?;
    if !arguments.json.json {
        let rig = match checked.simulated {
            true => "",
            false => "; real rig, no [sim]",
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

/// Runs the checks, and stores the results in `checked`.
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
    // Building the session checks properties of the whole: reach, visibility, calibration.
    let layouts = match config.sim {
        Some(_) => Session::new(&experiment)?.layouts().to_vec(),
        None => check_rig(&experiment)?,
    };
    check_shared_servos(config)?;
    checked.elements = layouts.iter().map(|layout| layout.elements.len()).collect();
    Ok(())
}

/// Lists every value that is out of range, or the error that ended the check.
fn problems(error: &(dyn Error + 'static)) -> Vec<String> {
    match error.downcast_ref::<ConfigError>() {
        Some(ConfigError::OutOfRange { problems, .. }) => {
            problems.iter().map(ToString::to_string).collect()
        }
        _ => vec![error.to_string()],
    }
}

/// Formats the numbers of elements: a single number if all fingers have the same.
fn elements(counts: &[usize]) -> String {
    let mut counts: Vec<_> = counts.iter().map(ToString::to_string).collect();
    if counts.iter().all(|count| *count == counts[0]) {
        counts.truncate(1);
    }
    counts.join(", ")
}
