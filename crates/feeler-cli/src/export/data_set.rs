//! The `feeler export lerobot` subcommand.

use super::DataSetArguments;
use super::folder::NewFolder;
use super::runs::Run;
use crate::{CommandError, Outcome};
use feeler_console::{Steps, watch_for_interrupt};
use feeler_export::{ExportError, lerobot};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

pub fn export(arguments: &DataSetArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let runs = Run::find_all(&arguments.runs)?;
    let inputs = runs.iter().map(|run| run.path.as_path());
    let folder = NewFolder::create(&arguments.output, arguments.force, inputs)?;
    let interrupted = watch_for_interrupt()?;
    let mut data_set = lerobot::DataSet::new(folder.part());
    let mut frames = 0;
    for run in &runs {
        match add(&mut data_set, run, arguments.task.as_deref(), &interrupted)? {
            Some(added) => frames += added,
            None => {
                writeln!(out, "interrupted: nothing was exported")?;
                return Ok(Outcome::GivenUp);
            }
        }
    }
    data_set.finish()?;
    folder.rename()?;
    let (path, episodes) = (arguments.output.display(), runs.len());
    writeln!(out, "{path}: {episodes} episodes, {frames} frames")?;
    Ok(Outcome::Done)
}

/// Adds a run to the data set; returns its number of frames, or `None` if interrupted.
fn add(
    data_set: &mut lerobot::DataSet,
    run: &Run,
    task: Option<&str>,
    interrupted: &AtomicBool,
) -> Result<Option<usize>, CommandError> {
    if interrupted.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let recording = run.read()?;
    let cameras = recording.fingers.iter().filter(|f| !f.pictures.is_empty());
    let progress = Steps::new(cameras.count() * recording.task.len());
    let episode = lerobot::Run {
        name: &run.name,
        task: task.unwrap_or(&recording.facts.experiment),
        recording: &recording,
        path: &run.path,
    };
    let watch = lerobot::Watch {
        interrupted,
        picture_done: &|| progress.advance(),
    };
    match data_set.add(&episode, watch) {
        Ok(frames) => Ok(Some(frames)),
        Err(ExportError::Interrupted) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
