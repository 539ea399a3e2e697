//! The `feeler export parquet` subcommand.

use super::TableArguments;
use super::runs::Run;
use crate::{CommandError, Outcome};
use feeler_console::{Outputs, PartFile, watch_for_interrupt};
use feeler_export::table;
use feeler_report::run::create_folder;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

pub fn export(arguments: &TableArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let runs = Run::find_all(&arguments.runs)?;
    let files = files(&runs, &arguments.output)?;
    let inputs = runs.iter().map(|run| Some(run.path.as_path()));
    let mut outputs = Outputs::new(arguments.overwrite.force, inputs);
    let interrupted = watch_for_interrupt()?;
    let mut parts = Vec::new();
    let written = write_all(&runs, &files, &mut outputs, &mut parts, &interrupted);
    let problems = match written {
        Ok(Some(problems)) => problems,
        ended => {
            // Export all tables or none.
            parts.into_iter().for_each(PartFile::discard);
            ended?;
            writeln!(out, "interrupted: nothing was exported")?;
            return Ok(Outcome::GivenUp);
        }
    };
    for (part, file) in parts.into_iter().zip(&files) {
        part.rename()?;
        writeln!(out, "{}", file.display())?;
    }
    if problems.is_empty() {
        return Ok(Outcome::Done);
    }
    Err(problems.join("\n").into())
}

/// Returns the path of each run's table.
fn files(runs: &[Run], output: &Path) -> Result<Vec<PathBuf>, CommandError> {
    let refuse = |what: String| Err(format!("--output {}: {what}", output.display()).into());
    if output.extension().is_some_and(|end| end == "parquet") {
        return match runs {
            [_] => Ok(vec![output.to_path_buf()]),
            runs => refuse(format!(
                "expected a folder for {} runs; a .parquet file can contain only one",
                runs.len()
            )),
        };
    }
    let mut names: Vec<_> = runs.iter().map(|run| run.name.as_str()).collect();
    names.sort_unstable();
    if let Some(name) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return refuse(format!(
            "two runs are named {}; rename one, or export them separately",
            name[0]
        ));
    }
    if let Err(error) = create_folder(output) {
        return refuse(format!("{error}; expected a folder, or a file *.parquet"));
    }
    let file = |run: &Run| output.join(format!("{}.parquet", run.name));
    Ok(runs.iter().map(file).collect())
}

/// Writes the partial table of each run; returns the problems of the recordings, or `None` if interrupted.
fn write_all(
    runs: &[Run],
    files: &[PathBuf],
    outputs: &mut Outputs,
    parts: &mut Vec<PartFile>,
    interrupted: &AtomicBool,
) -> Result<Option<Vec<String>>, CommandError> {
    let mut problems = Vec::new();
    for (run, path) in runs.iter().zip(files) {
        if interrupted.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let recording = run.read()?;
        let file = outputs.create(path, "--output")?;
        let writer = file.writer();
        parts.push(file);
        table::write(&run.name, &recording, writer?)
            .map_err(|error| format!("--output {}: {error}", path.display()))?;
        if let Some(problem) = &recording.problem {
            let (path, until) = (run.path.display(), recording.readable_until);
            problems.push(format!(
                "{path}: the recording is incomplete ({problem}); exported up to {until:.2} s"
            ));
        }
    }
    Ok(Some(problems))
}
