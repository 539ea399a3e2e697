//! The `feeler completions` and `feeler man` subcommands.

use super::{CommandError, Outcome, command_line};
use clap::Command;
use clap_complete::{Shell, generate};
use clap_mangen::Man;
use std::io::Write;

/// Name of the program.
const NAME: &str = "feeler";

#[derive(Debug, clap::Args)]
pub struct CompletionsArguments {
    /// Shell to generate completions for.
    shell: Shell,
}

#[derive(Debug, clap::Args)]
pub struct ManArguments {
    /// Command to document [default: the whole program]
    command: Option<String>,
}

/// Prints a shell completion script.
pub fn completions(
    arguments: &CompletionsArguments,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    // `generate` panics if writing fails; writing to memory cannot fail.
    let mut script = Vec::new();
    generate(arguments.shell, &mut command_line(), NAME, &mut script);
    out.write_all(&script)?;
    Ok(Outcome::Done)
}

/// Prints a manual page.
pub fn man(arguments: &ManArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let mut program = command_line();
    program.build();
    let command = match &arguments.command {
        None => program,
        Some(name) => {
            let names = program.get_subcommands().map(Command::get_name);
            let names = names.collect::<Vec<_>>().join(", ");
            let command = program.find_subcommand(name);
            let command = command
                .ok_or_else(|| format!("man {name}: unknown command; expected one of {names}"))?;
            command.clone()
        }
    };
    Man::new(command).render(out)?;
    Ok(Outcome::Done)
}
