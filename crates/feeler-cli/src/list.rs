//! `feeler list`

use super::{CommandError, Outcome};
use feeler_lab::config::{BUILT_IN, Experiment};
use std::io::Write;

pub fn list(out: &mut dyn Write) -> Result<Outcome, CommandError> {
    for built_in in BUILT_IN {
        let experiment = Experiment::load(built_in.name, &[])?;
        let description = &experiment.config.description;
        writeln!(out, "{:16} {description}", built_in.name)?;
    }
    Ok(Outcome::Done)
}
