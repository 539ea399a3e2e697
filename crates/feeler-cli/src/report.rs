//! The `feeler report` subcommand.

use super::progress::Reading;
use super::{CommandError, Outcome};
use feeler_lab::experiment::run_folder;
use feeler_report::cap::CapMeasures;
use feeler_report::criterion::Success;
use feeler_report::make::{
    RECORDING, REPORT, ReportError, ReportOutcome, SUMMARY, make_into, make_with,
};
use feeler_report::{Summary, Verdict};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder of the run, or a recording (FILE.mcap).
    ///
    /// The report of a recording that is not called recording.mcap is written to a folder next to it: the report of
    /// z.mcap to z, the report of z to z-report.
    run: PathBuf,
}

pub fn report(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let (recording, folder) = find(&arguments.run)?;
    let reading = Reading::new();
    let made = make_into(&recording, &folder, &mut |share| reading.show(share))?;
    drop(reading);
    print_outcome(&made, out)?;
    if let Some(problem) = &made.problem {
        let readable_until = made.readable_until;
        return Err(format!(
            "{}: the recording is incomplete ({problem}); the report covers the run up to \
             {readable_until:.2} s",
            arguments.run.display()
        )
        .into());
    }
    Ok(Outcome::Done)
}

/// Creates the report of the run in `folder`, with a progress bar.
pub fn made(folder: &Path) -> Result<ReportOutcome, ReportError> {
    let reading = Reading::new();
    make_with(folder, &mut |share| reading.show(share))
}

/// Returns the recording at `path` and the folder of its report: its own folder, or a new one next to it if the
/// recording has a custom name.
fn find(path: &Path) -> Result<(PathBuf, PathBuf), CommandError> {
    let recording = run_folder::recording(path)?;
    if recording.ends_with(RECORDING) {
        let folder = recording.parent().unwrap_or(Path::new("")).to_path_buf();
        return Ok((recording, folder));
    }
    let mut folder = recording.with_extension("");
    if folder == recording {
        folder.as_mut_os_string().push("-report");
    }
    if folder.join(RECORDING).exists() {
        let (recording, folder) = (recording.display(), folder.display());
        return Err(format!(
            "{recording}: its report would be written into {folder}, the folder of another run; rename the recording"
        )
        .into());
    }
    let has_other = [REPORT, SUMMARY]
        .iter()
        .any(|file| folder.join(file).exists());
    if has_other && !has_report(&folder) {
        let (recording, folder) = (recording.display(), folder.display());
        return Err(format!(
            "{recording}: its report would be written into {folder}, which contains other files named {REPORT} or {SUMMARY}; \
             move them or rename the recording"
        )
        .into());
    }
    Ok((recording, folder))
}

/// Returns `true` if `folder` contains the report of a run, which may be replaced.
fn has_report(folder: &Path) -> bool {
    let text = std::fs::read_to_string(folder.join(SUMMARY)).unwrap_or_default();
    let summary: Result<serde_json::Value, _> = serde_json::from_str(&text);
    summary.is_ok_and(|summary| summary.get("claims").is_some())
}

/// Prints the result of a run, its measures and claims, and the path of its report.
pub fn print_outcome(made: &ReportOutcome, out: &mut dyn Write) -> io::Result<()> {
    let summary = &made.summary;
    write!(out, "{}", summary.state)?;
    if let Some(reason) = &summary.reason {
        write!(out, ": {reason}")?;
    }
    writeln!(out)?;
    if let Some(outcome) = &summary.outcome {
        writeln!(out, "outcome: {outcome}")?;
    }
    let achieved = achieved(summary);
    if !achieved.is_empty() {
        writeln!(out, "{}", achieved.join(", "))?;
    }
    print_claims(made, out)?;
    if let Some(judged) = summary.success.and_then(Success::beyond_claims) {
        writeln!(out, "{judged}")?;
    }
    writeln!(out, "{}", made.report_path.display())
}

/// Lists the measured results of the hand.
fn achieved(summary: &Summary) -> Vec<String> {
    let mut achieved = Vec::new();
    // Opening a cap ends at its loosest.
    let opens = |cap: &&CapMeasures| cap.sense.is_some_and(|sense| sense < 0.0);
    if let Some(cap) = summary.cap.as_ref().filter(opens) {
        let torque = cap.largest_torque;
        achieved.extend(torque.map(|t| format!("largest torque {:.1} mN m", 1e3 * t)));
    } else if let Some(torque) = summary.final_torque {
        let ratio = summary.cap.as_ref().and_then(|cap| cap.torque_ratio);
        let share = ratio.map(|r| format!(" ({:.0} % of the friction limit)", 1e2 * r));
        let share = share.unwrap_or_default();
        achieved.push(format!("final torque {:.1} mN m{share}", 1e3 * torque));
    }
    let turned = summary.cap_angle.map(f64::to_degrees);
    achieved.extend(turned.map(|angle| format!("cap turned by {angle:.1}°")));
    let force = summary.peak_element_force;
    achieved.extend(force.map(|force| format!("peak element force {force:.2} N")));
    achieved
}

/// Prints the number of claims that pass, and those that do not.
fn print_claims(made: &ReportOutcome, out: &mut dyn Write) -> io::Result<()> {
    let claims = made.claims();
    if claims.is_empty() {
        return Ok(());
    }
    let holding = claims.iter().filter(|claim| claim.holds).count();
    let (count, whose) = (claims.len(), made.whose);
    writeln!(out, "{holding} of {count} claims {whose} pass")?;
    for claim in claims {
        let why = match claim.verdict {
            Verdict::Holds => continue,
            Verdict::Fails => "fails",
            Verdict::NotMeasured => "not measured",
        };
        writeln!(out, "  {why}: {} ({})", claim.id, claim.bound)?;
    }
    Ok(())
}
