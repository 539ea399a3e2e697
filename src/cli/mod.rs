//! The command line: one file per subcommand, each from arguments to an exit code.

mod calibrate;
mod check;
mod list;
mod report;
mod run;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Tri-axial touch to finger motion, and a simulated hand to try it on.
///
/// Exit status: 0 done; 1 the task was given up or interrupted; 2 bad input.
#[derive(Debug, Parser)]
#[command(name = "feeler", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run an experiment and write its recording, report and summary.
    Run(run::Arguments),
    /// List the built-in experiments.
    List,
    /// Check an experiment file without running it.
    Check(check::Arguments),
    /// Make a run's report again from its recording alone.
    Report(report::Arguments),
    /// Calibrate a fingertip: load its elements, take pictures, fit.
    Calibrate(calibrate::Arguments),
}

/// What a subcommand ends with when its input was good.
enum Outcome {
    Done,
    GivenUp,
}

type CommandError = Box<dyn std::error::Error>;

/// Runs the program on the process's arguments.
pub fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Run(arguments) => run::run(&arguments),
        Command::List => list::list(),
        Command::Check(arguments) => check::check(&arguments),
        Command::Report(arguments) => report::report(&arguments),
        Command::Calibrate(arguments) => calibrate::calibrate(&arguments),
    };
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::GivenUp) => ExitCode::from(1),
        Err(error) => {
            eprintln!("feeler: {error}");
            ExitCode::from(2)
        }
    }
}
