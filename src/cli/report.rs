//! `feeler report`

use super::{CommandError, Outcome};
use crate::report::make::{ReportOutcome, make};
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The run's folder.
    run: PathBuf,
}

pub fn report(arguments: &Arguments) -> Result<Outcome, CommandError> {
    let made = make(&arguments.run)?;
    print_claims(&made);
    if let Some(problem) = &made.problem {
        let readable_until = made.readable_until;
        return Err(format!(
            "{}: the recording is incomplete ({problem}); the report shows the run up to \
             {readable_until:.2} s and says so",
            arguments.run.display()
        )
        .into());
    }
    Ok(Outcome::Done)
}

/// Prints the verdict and where to read more.
pub fn print_claims(made: &ReportOutcome) {
    let claims = made.claims();
    let holding = claims.iter().filter(|claim| claim.holds).count();
    println!("{holding} of {} of the paper's claims hold", claims.len());
    for claim in claims.iter().filter(|claim| !claim.holds) {
        println!("  does not hold: {} ({})", claim.id, claim.bound);
    }
    println!("{}", made.report_path.display());
}
