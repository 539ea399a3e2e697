//! `feeler export lerobot`

use super::DataSetArguments;
use super::folder::NewFolder;
use super::runs::Run;
use crate::interrupt::watch_for_interrupt;
use crate::{CommandError, Outcome};
use feeler_export::lerobot;
use std::io::Write;
use std::sync::atomic::Ordering;

pub fn export(arguments: &DataSetArguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let runs = Run::find_all(&arguments.runs)?;
    let inputs = runs.iter().map(|run| run.path.as_path());
    let folder = NewFolder::create(&arguments.output, arguments.force, inputs)?;
    let interrupted = watch_for_interrupt()?;
    let mut data_set = lerobot::DataSet::new(folder.part());
    let mut frames = 0;
    for run in &runs {
        if interrupted.load(Ordering::Relaxed) {
            writeln!(out, "interrupted: nothing was exported")?;
            return Ok(Outcome::GivenUp);
        }
        let recording = run.read()?;
        let task = arguments.task.as_deref();
        frames += data_set.add(&lerobot::Run {
            name: &run.name,
            task: task.unwrap_or(&recording.facts.experiment),
            recording: &recording,
        })?;
    }
    data_set.finish()?;
    folder.rename()?;
    let (path, episodes) = (arguments.output.display(), runs.len());
    writeln!(out, "{path}: {episodes} episodes, {frames} frames")?;
    Ok(Outcome::Done)
}
