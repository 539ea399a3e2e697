//! The `feeler report` subcommand.

use crate::{CommandError, Outcome};
use feeler_console::Reading;
use feeler_lab::experiment::run_folder;
use feeler_report::run::{RECORDING, REPORT, SUMMARY, make_into};
use feeler_rig::print_outcome;
use std::io::Write;
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
