//! Creates the report of a run from its recording.

use super::data::RunData;
pub use super::file_names::{FIGURES, RECORDING, REPORT, SUMMARY};
use super::long_run;
use crate::figures::Figure;
use crate::measures::claim::Claim;
use crate::measures::criterion::Success;
use crate::measures::summary::Summary;
use crate::page_data::RunTable;
use crate::pages::run::page;
use crate::tasks;
use feeler_record::{RecordError, Recording};
use std::io::{self, ErrorKind, Read, Seek, Write};
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::{fs, thread};

/// Suffix for files of an earlier report whose recording has become unreadable.
const STALE: &str = ".stale";

/// Error of report creation.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The recording is missing or unreadable.
    #[error(transparent)]
    Recording(#[from] RecordError),
    /// The recording is unreadable, and an earlier report was renamed.
    #[error("{error}; the earlier report cannot be verified any more and was renamed to {files}")]
    SetAside {
        /// Error of the recording.
        error: RecordError,
        /// New names of the earlier report's files.
        files: String,
    },
    /// A file of the report could not be written.
    #[error("report {path}: {source}")]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Underlying I/O error.
        source: std::io::Error,
    },
}

/// Result of [`make`].
#[derive(Debug, Clone, PartialEq)]
pub struct ReportOutcome {
    /// Path of `report.html`.
    pub report_path: PathBuf,
    /// Path of `summary.json`.
    pub summary_path: PathBuf,
    /// `true` if the recording is complete.
    pub complete: bool,
    /// Defect of the recording, if it is incomplete.
    pub problem: Option<String>,
    /// Time up to which the recording is readable (s).
    pub readable_until: f64,
    /// Content of `summary.json`.
    pub summary: Summary,
    /// Phrase that follows the word "claims" and names their origin, such as "of the paper".
    pub whose: &'static str,
}

impl ReportOutcome {
    /// Claims shown in the report: those of the task, or those about any hand if the law is not the paper's.
    pub fn claims(&self) -> &[Claim] {
        self.summary.shown_claims()
    }
}

/// Reads `recording.mcap` in `run_dir` and writes `report.html`, `summary.json` and the figures next to it. A damaged
/// recording yields a report of its readable part, marked as incomplete. If nothing is readable, files of an earlier
/// report are renamed so that they are not mistaken for a report of this recording.
///
/// # Errors
/// If the recording is unreadable or a file cannot be written.
pub fn make(run_dir: impl AsRef<Path>) -> Result<ReportOutcome, ReportError> {
    make_with(run_dir, &mut |_| {})
}

/// Like [`make`], but calls `progress` with the fraction of the recording that has been read (0 to 1). Memory use is
/// bounded, independent of the recording's length (`long_run`).
///
/// # Errors
/// Same as [`make`].
pub fn make_with(
    run_dir: impl AsRef<Path>,
    progress: &mut dyn FnMut(f64),
) -> Result<ReportOutcome, ReportError> {
    let run_dir = run_dir.as_ref();
    make_into(&run_dir.join(RECORDING), run_dir, progress)
}

/// Like [`make_with`], but for the recording at `path` and the output folder `folder`, which is created if missing.
/// `folder` must be the recording's folder or a subfolder of it.
///
/// # Errors
/// Same as [`make`].
pub fn make_into(
    path: &Path,
    folder: &Path,
    progress: &mut dyn FnMut(f64),
) -> Result<ReportOutcome, ReportError> {
    let (recording, data) = read(path, folder, progress)?;
    create_folder(folder).map_err(failed(folder))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let link = match path.parent() == Some(folder) {
        true => name.into_owned(),
        false => format!("../{name}"),
    };
    write_report(folder, &link, &recording, &data)
}

/// Like [`make`], but for a `recording` in memory with rows `data`.
///
/// # Errors
/// If a file cannot be written.
pub fn make_of(
    run_dir: &Path,
    recording: &Recording,
    data: &RunData,
) -> Result<ReportOutcome, ReportError> {
    write_report(run_dir, RECORDING, recording, data)
}

/// Writes the report of a recording into `run_dir`. `link` is the relative path from there to the recording.
fn write_report(
    run_dir: &Path,
    link: &str,
    recording: &Recording,
    data: &RunData,
) -> Result<ReportOutcome, ReportError> {
    // Remove the earlier report first, so that an error cannot leave a mix of old and new files.
    let [report_path, summary_path] = [REPORT, SUMMARY].map(|name| run_dir.join(name));
    remove(&report_path)?;
    remove(&summary_path)?;
    let drawn = draw(recording, data, link, |figures, summary| {
        write_figures(&run_dir.join(FIGURES), figures)?;
        let json = summary.to_json().map_err(io::Error::from);
        write_whole(
            &summary_path,
            json.map_err(failed(&summary_path))?.as_bytes(),
        )
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

/// Report page of a recording in memory, equal to the `report.html` written by [`make`]. Writes no files.
pub fn page_of(recording: &Recording) -> String {
    page_of_rows(recording, &RunData::new(recording))
}

/// Like [`page_of`], but with existing rows.
pub fn page_of_rows(recording: &Recording, data: &RunData) -> String {
    draw(recording, data, RECORDING, |_, _| ()).html
}

/// Report page of the recording at `path`. Writes no files.
///
/// # Errors
/// If the recording is unreadable.
pub fn page_of_file(
    path: impl AsRef<Path>,
    progress: &mut dyn FnMut(f64),
) -> Result<String, RecordError> {
    let (recording, data) = long_run::read(path, progress)?;
    Ok(page_of_rows(&recording, &data))
}

/// Report page of an open recording of `length` bytes. Errors name the recording `path`. Writes no files.
///
/// # Errors
/// If the recording is unreadable.
pub fn page_from(
    file: &mut (impl Read + Seek),
    length: u64,
    path: &Path,
    progress: &mut dyn FnMut(f64),
) -> Result<String, RecordError> {
    let (recording, data) = long_run::read_from(file, length, path, progress)?;
    Ok(page_of_rows(&recording, &data))
}

/// Summary of an open recording of `length` bytes: the content of `summary.json`. Errors name the recording `path`.
/// Faster than [`page_from`], because no figures are drawn.
///
/// # Errors
/// If the recording is unreadable.
pub fn summary_from(
    file: &mut (impl Read + Seek),
    length: u64,
    path: &Path,
) -> Result<Summary, RecordError> {
    let (recording, data) = long_run::read_from(file, length, path, &mut |_| {})?;
    Ok(summarize(&recording, &data))
}

/// Summary of a recording, without the paper's claims if they do not apply to its task. [`Summary::new`] always contains
/// them, because trial tables have the same columns for every law.
fn summarize(recording: &Recording, data: &RunData) -> Summary {
    let mut summary = Summary::new(recording, data);
    summary.success = Success::of(&recording.facts, &summary);
    if !tasks::claims_are_shown(&recording.facts) {
        summary.claims.clear();
    }
    summary
}

/// A drawn report, and the result of the callback of [`draw`].
struct Drawn<T> {
    html: String,
    summary: Summary,
    whose: &'static str,
    given: T,
}

/// Draws the page of `recording`. Calls `give` with figures and summary while the page data are still being compressed,
/// which takes longest.
fn draw<T>(
    recording: &Recording,
    data: &RunData,
    link: &str,
    give: impl FnOnce(&[Figure], &Summary) -> T,
) -> Drawn<T> {
    thread::scope(|scope| {
        // Platforms without threads, such as browsers, compress at the end.
        let table = thread::Builder::new().spawn_scoped(scope, || RunTable::new(data));
        let summary = summarize(recording, data);
        let task = tasks::of_recording(recording);
        let figures = task.figures(recording, data);
        let given = give(&figures, &summary);
        let table = match table {
            Ok(table) => table.join().unwrap_or_else(|panic| resume_unwind(panic)),
            Err(_) => RunTable::new(data),
        };
        let html = page(recording, link, data, table, &summary, &figures);
        let (_, whose) = tasks::shown_claims(recording, &summary);
        Drawn {
            html,
            summary,
            whose,
            given,
        }
    })
}

/// Returns a function that adds `path` to an error of the operating system.
fn failed(path: &Path) -> impl Fn(io::Error) -> ReportError + use<'_> {
    move |source| ReportError::Write {
        path: path.to_path_buf(),
        source,
    }
}

/// Creates a folder and its parents if they are missing.
///
/// # Errors
/// If the folder cannot be created. Names the file that occupies the path or one of its parents.
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

/// Writes each figure to a separate file in `directory` and removes outdated files of figures that were not drawn.
fn write_figures(directory: &Path, figures: &[Figure]) -> Result<(), ReportError> {
    create_folder(directory).map_err(failed(directory))?;
    figures.iter().try_for_each(|figure| {
        let path = directory.join(figure.file_name());
        match &figure.svg {
            Some(svg) => write_whole(&path, svg.as_bytes()),
            None => remove(&path),
        }
    })
}

/// Reads the recording at `path`. If it is unreadable, renames the earlier report in `run_dir`.
fn read(
    path: &Path,
    run_dir: &Path,
    progress: &mut dyn FnMut(f64),
) -> Result<(Recording, RunData), ReportError> {
    let error = match long_run::read(path, progress) {
        Ok(read) => return Ok(read),
        Err(error) => error,
    };
    // If the recording is missing, this may not be a run's folder; leave its files alone.
    if !matches!(error, RecordError::NothingReadable { .. }) {
        return Err(error.into());
    }
    let mut set_aside = Vec::new();
    for name in [REPORT, SUMMARY] {
        let (path, stale) = (run_dir.join(name), format!("{name}{STALE}"));
        if path.exists() {
            fs::rename(&path, run_dir.join(&stale)).map_err(failed(&path))?;
            set_aside.push(stale);
        }
    }
    if set_aside.is_empty() {
        return Err(error.into());
    }
    let files = set_aside.join(", ");
    Err(ReportError::SetAside { error, files })
}

/// Removes a file of an earlier report, if present.
fn remove(path: &Path) -> Result<(), ReportError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(failed(path)(error)),
        _ => Ok(()),
    }
}

/// Writes a file atomically.
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
        // Best effort: the partial file may not exist.
        let _ = fs::remove_file(&part);
        failed(path)(source)
    })
}
