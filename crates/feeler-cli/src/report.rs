//! `feeler report`

use super::{CommandError, Outcome};
use feeler_console::Reading;
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
    /// The run's folder, or a recording (FILE.mcap). The report of a recording that is not called recording.mcap is written into a
    /// folder beside it: that of z.mcap into z, that of z into z-report.
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
            "{}: the recording is incomplete ({problem}); the report shows the run up to \
             {readable_until:.2} s and says so",
            arguments.run.display()
        )
        .into());
    }
    Ok(Outcome::Done)
}

/// Makes the report of the run in `folder`, and shows how far it got.
pub fn made(folder: &Path) -> Result<ReportOutcome, ReportError> {
    let reading = Reading::new();
    make_with(folder, &mut |share| reading.show(share))
}

/// The recording that is meant by `path`, and the folder of its report: its own or, if it has another name than in a run's folder, a
/// new one beside it.
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
            "{recording}: its report would be written into {folder}, which is the folder of another run; rename the recording"
        )
        .into());
    }
    let has_other = [REPORT, SUMMARY]
        .iter()
        .any(|file| folder.join(file).exists());
    if has_other && !has_report(&folder) {
        let (recording, folder) = (recording.display(), folder.display());
        return Err(format!(
            "{recording}: its report would be written into {folder}, whose {REPORT} or {SUMMARY} is no report of a run; move \
             them or rename the recording"
        )
        .into());
    }
    Ok((recording, folder))
}

/// Whether `folder` has the report of a run, which may be made again.
fn has_report(folder: &Path) -> bool {
    let text = std::fs::read_to_string(folder.join(SUMMARY)).unwrap_or_default();
    let summary: Result<serde_json::Value, _> = serde_json::from_str(&text);
    summary.is_ok_and(|summary| summary.get("claims").is_some())
}

/// Prints how the run ended and what was achieved, then how far it reproduces the paper, and where to read more.
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

/// What the hand achieved, as far as it was measured.
fn achieved(summary: &Summary) -> Vec<String> {
    let mut achieved = Vec::new();
    // A cap that is opened is loosest at the end.
    let opens = |cap: &&CapMeasures| cap.sense.is_some_and(|sense| sense < 0.0);
    if let Some(cap) = summary.cap.as_ref().filter(opens) {
        let torque = cap.largest_torque;
        achieved.extend(torque.map(|t| format!("largest torque {:.1} mN m", 1e3 * t)));
    } else if let Some(torque) = summary.final_torque {
        let ratio = summary.cap.as_ref().and_then(|cap| cap.torque_ratio);
        let share = ratio.map(|r| format!(" ({:.0} % of what friction allows)", 1e2 * r));
        let share = share.unwrap_or_default();
        achieved.push(format!("final torque {:.1} mN m{share}", 1e3 * torque));
    }
    let turned = summary.cap_angle.map(f64::to_degrees);
    achieved.extend(turned.map(|angle| format!("cap turned by {angle:.1}°")));
    let force = summary.peak_element_force;
    achieved.extend(force.map(|force| format!("peak element force {force:.2} N")));
    achieved
}

/// Prints how many claims hold, and which do not.
fn print_claims(made: &ReportOutcome, out: &mut dyn Write) -> io::Result<()> {
    let claims = made.claims();
    if claims.is_empty() {
        return Ok(());
    }
    let holding = claims.iter().filter(|claim| claim.holds).count();
    let (count, whose) = (claims.len(), made.whose);
    writeln!(out, "{holding} of {count} claims {whose} hold")?;
    for claim in claims {
        let why = match claim.verdict {
            Verdict::Holds => continue,
            Verdict::Fails => "does not hold",
            Verdict::NotMeasured => "not measured",
        };
        writeln!(out, "  {why}: {} ({})", claim.id, claim.bound)?;
    }
    Ok(())
}
