//! `feeler check`

use super::{CommandError, Outcome};
use feeler::sensor::layout::ElementLayout;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::warnings::warnings;
use feeler_lab::experiment::{Session, check_rig};
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// An experiment file, or the name of a built-in experiment.
    experiment: String,
    /// Check it with this value set, as in control.slip_threshold=2.5.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
}

pub fn check(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &arguments.settings)?;
    // Before what may be refused for the same mistake.
    for warning in warnings(&experiment) {
        writeln!(out, "warning: {warning}")?;
    }
    // Building everything checks what only the whole can tell: reach, sight, calibration.
    let config = &experiment.config;
    let (layouts, rig) = match config.sim {
        Some(_) => (Session::new(&experiment)?.layouts().to_vec(), ""),
        None => (
            check_rig(&experiment)?,
            "; a real rig, as there is no [sim]",
        ),
    };
    writeln!(
        out,
        "{}: good ({}; {} fingers of {} elements, {} strokes{rig})",
        arguments.experiment,
        config.name,
        config.hand.finger.len(),
        elements(&layouts),
        config.task.strokes(),
    )?;
    Ok(Outcome::Done)
}

/// How many elements the fingers have: one number, or one for each where they differ.
fn elements(layouts: &[ElementLayout]) -> String {
    let mut counts: Vec<_> = layouts
        .iter()
        .map(|l| l.elements.len().to_string())
        .collect();
    if counts.iter().all(|count| *count == counts[0]) {
        counts.truncate(1);
    }
    counts.join(", ")
}
