//! `feeler report`

use super::{CommandError, Outcome};
use feeler_record::TaskOutcome;
use feeler_report::cap::CapMeasures;
use feeler_report::make::{RECORDING, ReportOutcome, make};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The run's folder, or the recording in it.
    run: PathBuf,
}

pub fn report(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let folder = folder(&arguments.run)?;
    let made = make(folder)?;
    print_claims(&made, out)?;
    if let Some(problem) = &made.problem {
        let readable_until = made.readable_until;
        return Err(format!(
            "{}: the recording is incomplete ({problem}); the report shows the run up to \
             {readable_until:.2} s and says so",
            folder.display()
        )
        .into());
    }
    Ok(Outcome::Done)
}

/// The folder of the run that is meant by `path`.
fn folder(path: &Path) -> Result<&Path, CommandError> {
    if path.join(RECORDING).exists() {
        return Ok(path);
    }
    match path.parent() {
        Some(folder) if path.is_file() && path.ends_with(RECORDING) => Ok(folder),
        _ => Err(format!(
            "{}: there is no recording; expected the folder of a run, with {RECORDING} in it",
            path.display()
        )
        .into()),
    }
}

/// Prints the verdict and where to read more.
pub fn print_claims(made: &ReportOutcome, out: &mut dyn Write) -> io::Result<()> {
    if let Some(cap) = &made.summary.cap {
        return print_cap(made, cap, out);
    }
    let claims = made.claims();
    let holding = claims.iter().filter(|claim| claim.holds).count();
    let (count, whose) = (claims.len(), made.whose);
    writeln!(out, "{holding} of {count} claims {whose} hold")?;
    for claim in claims.iter().filter(|claim| !claim.holds) {
        let why = if claim.is_measured() {
            "does not hold"
        } else {
            "not measured"
        };
        writeln!(out, "  {why}: {} ({})", claim.id, claim.bound)?;
    }
    writeln!(out, "{}", made.report_path.display())
}

/// Prints what became of a cap and where to read more.
fn print_cap(made: &ReportOutcome, cap: &CapMeasures, out: &mut dyn Write) -> io::Result<()> {
    let outcome = made
        .summary
        .outcome
        .as_ref()
        .map_or("none", TaskOutcome::as_str);
    writeln!(out, "outcome: {outcome}")?;
    let share = cap.torque_ratio.filter(|_| cap.sense > 0.0);
    if let (Some(torque), Some(share)) = (cap.final_torque, share) {
        let (torque, share) = (1e3 * torque, 1e2 * share);
        writeln!(
            out,
            "torque of the last stroke: {torque:.1} mN m, {share:.0} % of what friction allows"
        )?;
    } else if let Some(torque) = cap.largest_torque {
        writeln!(out, "largest torque: {:.1} mN m", 1e3 * torque)?;
    }
    writeln!(out, "{}", made.report_path.display())
}
