//! The `feeler list` subcommand.

use crate::options::Json;
use crate::{CommandError, Outcome};
use feeler::sensor::taxel::{BUILT_IN_TAXELS, BuiltInTaxels};
use feeler_console::print_json;
use feeler_lab::config::{BUILT_IN, Experiment};
use serde::Serialize;
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Print the layout file of a built-in taxel array instead, as a starting point.
    #[arg(long, value_name = "NAME", conflicts_with = "json")]
    taxels: Option<String>,
    #[command(flatten)]
    json: Json,
}

/// An experiment or taxel array.
#[derive(Serialize)]
struct Named {
    name: &'static str,
    description: String,
}

/// Output of `--json`.
#[derive(Serialize)]
struct Listed {
    experiments: Vec<Named>,
    taxels: Vec<Named>,
}

impl Listed {
    fn new() -> Result<Self, CommandError> {
        let experiment = |name| -> Result<Named, CommandError> {
            let description = Experiment::load(name, &[])?.config.description;
            Ok(Named { name, description })
        };
        let array = |built_in: BuiltInTaxels| -> Result<Named, CommandError> {
            Ok(Named {
                name: built_in.name,
                description: built_in.layout()?.description,
            })
        };
        let experiments = BUILT_IN.into_iter().map(|b| experiment(b.name));
        Ok(Self {
            experiments: experiments.collect::<Result<_, _>>()?,
            taxels: BUILT_IN_TAXELS
                .into_iter()
                .map(array)
                .collect::<Result<_, _>>()?,
        })
    }
}

pub fn list(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    if let Some(name) = &arguments.taxels {
        let named = BUILT_IN_TAXELS.map(|built_in| built_in.name).join(", ");
        let expected = || format!("--taxels {name}: expected one of {named}");
        let built_in = BuiltInTaxels::named(name).ok_or_else(expected)?;
        write!(out, "{}", built_in.text)?;
        return Ok(Outcome::Done);
    }
    let listed = Listed::new()?;
    if arguments.json.json {
        print_json(&listed, out)?;
        return Ok(Outcome::Done);
    }
    for Named { name, description } in listed.experiments {
        writeln!(out, "{name:18} {description}")?;
    }
    writeln!(out, "\nTaxel arrays for feeler sense --taxels:")?;
    for Named { name, description } in listed.taxels {
        writeln!(out, "{name:18} {description}")?;
    }
    Ok(Outcome::Done)
}
