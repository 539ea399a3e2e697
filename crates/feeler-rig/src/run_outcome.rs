//! Result of a run, as text.

use feeler_console::Reading;
use feeler_report::measures::{CapMeasures, Success};
use feeler_report::run::make::{ReportError, ReportOutcome, make_with};
use feeler_report::{Summary, Verdict};
use std::io::{self, Write};
use std::path::Path;

/// Writes the report of the run in `folder` and shows the progress.
///
/// # Errors
/// If the recording cannot be read or the report cannot be written.
pub fn make_report(folder: &Path) -> Result<ReportOutcome, ReportError> {
    let reading = Reading::new();
    make_with(folder, &mut |share| reading.show(share))
}

/// Prints the end of a run, its main results, the claims that fail and the path of its report.
///
/// # Errors
/// If `out` cannot be written.
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

/// Describes the measured main results of a run.
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

/// Prints the number of claims that pass and names the others.
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
