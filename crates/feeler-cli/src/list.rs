//! `feeler list`

use super::{CommandError, Outcome};
use feeler::sensor::taxel::{BUILT_IN_TAXELS, BuiltInTaxels};
use feeler_lab::config::{BUILT_IN, Experiment};
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Print the layout of a built-in taxel array instead, to start from.
    #[arg(long, value_name = "NAME")]
    taxels: Option<String>,
}

pub fn list(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    if let Some(name) = &arguments.taxels {
        let named = BUILT_IN_TAXELS.map(|built_in| built_in.name).join(", ");
        let expected = || format!("--taxels {name}: expected one of {named}");
        let built_in = BuiltInTaxels::named(name).ok_or_else(expected)?;
        write!(out, "{}", built_in.text)?;
        return Ok(Outcome::Done);
    }
    for built_in in BUILT_IN {
        let experiment = Experiment::load(built_in.name, &[])?;
        let description = &experiment.config.description;
        writeln!(out, "{:18} {description}", built_in.name)?;
    }
    writeln!(out, "\nTaxel arrays, for feeler sense --taxels:")?;
    for built_in in BUILT_IN_TAXELS {
        let description = built_in.layout()?.description;
        writeln!(out, "{:18} {description}", built_in.name)?;
    }
    Ok(Outcome::Done)
}
