//! Makes a run's report from its recording.

use super::claim::Claim;
use super::criterion::Success;
use super::figures::Figure;
use super::long_run;
use super::page::page;
use super::page_data::RunTable;
use super::run_data::RunData;
use super::summary::Summary;
use super::tasks;
use feeler_record::{RecordError, Recording};
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::thread;

/// Name of the recording in a run's directory.
pub const RECORDING: &str = "recording.mcap";
/// Name of the page in a run's directory.
pub const REPORT: &str = "report.html";
/// Name of the directory of single figures in a run's directory.
pub const FIGURES: &str = "figures";
/// Name of the summary in a run's directory.
pub const SUMMARY: &str = "summary.json";
/// What is added to the names of an earlier report's files when their recording is of no use.
const STALE: &str = ".stale";

/// Why a report could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// There is no recording of which anything is readable.
    #[error(transparent)]
    Recording(#[from] RecordError),
    /// Nothing of the recording is readable, and there was an earlier report.
    #[error(
        "{error}; the earlier report cannot be held against it any more and is now called {files}"
    )]
    SetAside {
        /// What is wrong with the recording.
        error: RecordError,
        /// What the earlier report's files are called now.
        files: String,
    },
    /// A file of the report could not be written.
    #[error("report {path}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// What [`make`] made.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportOutcome {
    /// `report.html`.
    pub report_path: PathBuf,
    /// `summary.json`.
    pub summary_path: PathBuf,
    /// Whether the recording is whole.
    pub complete: bool,
    /// What is wrong with the recording, if it is not whole.
    pub problem: Option<String>,
    /// Time up to which the recording is readable, s.
    pub readable_until: f64,
    /// What stands in `summary.json`.
    pub summary: Summary,
    /// Whose the claims are, after the word "claims".
    pub whose: &'static str,
}

impl ReportOutcome {
    /// The claims that the report shows: those of the task, or those of any hand under a law other than the paper's.
    pub fn claims(&self) -> &[Claim] {
        self.summary.shown_claims()
    }
}

/// Reads `recording.mcap` in `run_dir` and writes `report.html`, `summary.json` and the figures,
/// one file each, beside it. A damaged recording
/// gives a report of what is readable, marked as incomplete. Of one of which nothing is readable, an
/// earlier report is set aside, so that it does not look as if it were the recording's.
///
/// # Errors
/// When nothing of the recording is readable or a file cannot be written.
pub fn make(run_dir: impl AsRef<Path>) -> Result<ReportOutcome, ReportError> {
    make_with(run_dir, &mut |_| {})
}

/// The same; `progress` is told the share of the recording that was read, 0 to 1. Needs little memory, however long the
/// recording is ([`long_run`]).
///
/// # Errors
/// As of [`make`].
pub fn make_with(
    run_dir: impl AsRef<Path>,
    progress: &mut dyn FnMut(f64),
) -> Result<ReportOutcome, ReportError> {
    let run_dir = run_dir.as_ref();
    make_into(&run_dir.join(RECORDING), run_dir, progress)
}

/// Like [`make_with`], but of the recording at `path`, into `folder`, which is made if it is missing. It may be that of the recording or
/// one beside it.
///
/// # Errors
/// As of [`make`].
pub fn make_into(
    path: &Path,
    folder: &Path,
    progress: &mut dyn FnMut(f64),
) -> Result<ReportOutcome, ReportError> {
    let (recording, data) = read(path, folder, progress)?;
    create_folder(folder).map_err(|source| ReportError::Write {
        path: folder.to_path_buf(),
        source,
    })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let link = match path.parent() == Some(folder) {
        true => name.into_owned(),
        false => format!("../{name}"),
    };
    write_report(folder, &link, &recording, &data)
}

/// The same of a `recording` whose rows are `data`, and which need not be read again.
///
/// # Errors
/// When a file cannot be written.
pub fn make_of(
    run_dir: &Path,
    recording: &Recording,
    data: &RunData,
) -> Result<ReportOutcome, ReportError> {
    write_report(run_dir, RECORDING, recording, data)
}

/// Writes the report of a recording into `run_dir`, from which `link` leads to it.
fn write_report(
    run_dir: &Path,
    link: &str,
    recording: &Recording,
    data: &RunData,
) -> Result<ReportOutcome, ReportError> {
    // Should anything go wrong from here on, no earlier report is left beside half of a new one.
    let [report_path, summary_path] = [REPORT, SUMMARY].map(|name| run_dir.join(name));
    remove(&report_path)?;
    remove(&summary_path)?;
    let drawn = draw(recording, data, link, |figures, summary| {
        write_figures(&run_dir.join(FIGURES), figures)?;
        let json = summary.to_json().map_err(|e| ReportError::Write {
            path: summary_path.clone(),
            source: e.into(),
        })?;
        write_whole(&summary_path, json.as_bytes())
    });
    let Drawn {
        html,
        summary,
        whose,
        given: written,
    } = drawn;
    written?;
    write_whole(&report_path, html.as_bytes())?;
    Ok(ReportOutcome {
        report_path,
        summary_path,
        complete: recording.complete,
        problem: recording.problem.clone(),
        readable_until: recording.readable_until,
        summary,
        whose,
    })
}

/// The page of a recording in memory: what [`make`] writes as `report.html`. Writes nothing.
pub fn page_of(recording: &Recording) -> String {
    page_of_rows(recording, &RunData::new(recording))
}

/// The same of a recording whose rows are `data`.
pub fn page_of_rows(recording: &Recording, data: &RunData) -> String {
    draw(recording, data, RECORDING, |_, _| ()).html
}

/// The page of the recording at `path`. Writes nothing.
///
/// # Errors
/// When nothing of the recording is readable.
pub fn page_of_file(
    path: impl AsRef<Path>,
    progress: &mut dyn FnMut(f64),
) -> Result<String, RecordError> {
    let (recording, data) = long_run::read(path, progress)?;
    Ok(page_of_rows(&recording, &data))
}

/// All that a report is made of, and what became of the parts that are drawn first.
struct Drawn<T> {
    html: String,
    summary: Summary,
    whose: &'static str,
    given: T,
}

/// Draws the page of `recording`; `give` has figures and summary while the page's numbers are still compressed, which takes longest.
fn draw<T>(
    recording: &Recording,
    data: &RunData,
    link: &str,
    give: impl FnOnce(&[Figure], &Summary) -> T,
) -> Drawn<T> {
    thread::scope(|scope| {
        let table = scope.spawn(|| RunTable::new(data));
        let mut summary = Summary::new(recording, data);
        summary.success = Success::of(&recording.facts, &summary);
        // A table of trials has the same columns for every law; a report holds to the paper only what is like it.
        if !tasks::claims_are_shown(&recording.facts) {
            summary.claims.clear();
        }
        let task = tasks::of_recording(recording);
        let figures = task.figures(recording, data);
        let given = give(&figures, &summary);
        let table = table.join().unwrap_or_else(|panic| resume_unwind(panic));
        let html = page((recording, link), data, table, &summary, &figures);
        let (_, whose) = tasks::shown_claims(recording, &summary);
        Drawn {
            html,
            summary,
            whose,
            given,
        }
    })
}

/// Makes a folder and those that it is in, unless it is there.
///
/// # Errors
/// If it cannot be made; names the file that is in its place, or in that of a folder above it.
pub fn create_folder(path: &Path) -> io::Result<()> {
    fs::create_dir_all(path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
            let files = path.ancestors().find(|part| part.is_file());
            let file = files.unwrap_or(path).display();
            io::Error::new(error.kind(), format!("{file} is a file"))
        }
        _ => error,
    })
}

/// Writes each figure that was drawn to a file of its own in `directory`; others are not left there from before.
fn write_figures(directory: &Path, figures: &[Figure]) -> Result<(), ReportError> {
    create_folder(directory).map_err(|source| ReportError::Write {
        path: directory.to_path_buf(),
        source,
    })?;
    figures.iter().try_for_each(|figure| {
        let path = directory.join(figure.file_name());
        match &figure.svg {
            Some(svg) => write_whole(&path, svg.as_bytes()),
            None => remove(&path),
        }
    })
}

/// Reads the recording at `path`, or sets aside the report in `run_dir` that it cannot back any more.
fn read(
    path: &Path,
    run_dir: &Path,
    progress: &mut dyn FnMut(f64),
) -> Result<(Recording, RunData), ReportError> {
    let error = match long_run::read(path, progress) {
        Ok(read) => return Ok(read),
        Err(error) => error,
    };
    // Without a recording this may be no run's folder at all, and its files are not ours.
    if !matches!(error, RecordError::NothingReadable { .. }) {
        return Err(error.into());
    }
    let mut set_aside = Vec::new();
    for name in [REPORT, SUMMARY] {
        let (path, stale) = (run_dir.join(name), format!("{name}{STALE}"));
        if path.exists() {
            fs::rename(&path, run_dir.join(&stale))
                .map_err(|source| ReportError::Write { path, source })?;
            set_aside.push(stale);
        }
    }
    if set_aside.is_empty() {
        return Err(error.into());
    }
    let files = set_aside.join(", ");
    Err(ReportError::SetAside { error, files })
}

/// Removes a file of an earlier report, if there is one.
fn remove(path: &Path) -> Result<(), ReportError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => Err(ReportError::Write {
            path: path.to_path_buf(),
            source,
        }),
        _ => Ok(()),
    }
}

/// Writes a file so that it is there whole or not at all.
fn write_whole(path: &Path, content: &[u8]) -> Result<(), ReportError> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".part");
    let part = path.with_file_name(name);
    let written = fs::File::create(&part)
        .and_then(|mut file| {
            file.write_all(content)?;
            file.sync_all()
        })
        .and_then(|()| fs::rename(&part, path));
    written.map_err(|source| {
        // The part is of no use to anyone; that it may not exist does not matter.
        let _ = fs::remove_file(&part);
        ReportError::Write {
            path: path.to_path_buf(),
            source,
        }
    })
}
