//! The `feeler export lerobot` subcommand.

use super::folder::NewFolder;
use super::runs::Run;
use super::{DataSetArguments, TouchRate};
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
    let sampling = sampling(arguments, &runs)?;
    let mut data_set = lerobot::DataSet::new(folder.part()).with_sampling(sampling);
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
    write!(out, "{path}: {episodes} episodes, {frames} frames")?;
    match sampling.window {
        Some(window) => writeln!(out, " with windows of {window} tactile samples")?,
        None => writeln!(out)?,
    }
    Ok(Outcome::Done)
}

/// Returns the requested frames and windows. The windows have the length of the longest one of all runs.
fn sampling(arguments: &DataSetArguments, runs: &[Run]) -> Result<lerobot::Sampling, CommandError> {
    let fps = arguments.fps;
    let window = match arguments.touch_rate {
        TouchRate::Frame => None,
        TouchRate::Native => {
            let mut longest = 1;
            for run in runs {
                longest = longest.max(lerobot::longest_window(&run.name, &run.read()?, fps)?);
            }
            Some(longest)
        }
    };
    Ok(lerobot::Sampling { fps, window })
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
