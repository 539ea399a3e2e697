//! Reconstruction of external stops and resumes in a recording.
//!
//! A recording contains the task's phase at every step, but not the cause of a stop. A controller with the recorded
//! settings repeats the stops that it caused itself. All other stops, and every resume, came from outside and are
//! repeated by the replay. A stop that was resumed before the next step leaves no trace and is not reconstructed.

use super::{ReplayError, control_loop, recorded_forces, steps};
use crate::config::Experiment;
use feeler::control::{Controller, Phase, StopReason, TactileReading};
use feeler::hand::{HandCommand, HandState};
use feeler_record::Recording;

/// Stop or resume requested from outside the control loop, applied before the controller decides a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outside {
    Stop,
    Resume,
}

impl Outside {
    pub fn apply(self, controller: &mut Controller) {
        match self {
            Self::Stop => controller.stop(StopReason::Recorded),
            Self::Resume => controller.resume(),
        }
    }
}

/// Returns the stops and resumes that did not come from the controller, in order, each with the index of the control
/// step before which it was requested. `experiment` must be the recorded experiment: its controller is replayed to
/// recognise the stops that it caused itself.
pub fn on_record(
    recording: &Recording,
    experiment: &Experiment,
) -> Result<Vec<(usize, Outside)>, ReplayError> {
    let stopped = |step: usize| recording.task[step].phase == Phase::Stopped;
    let steps = steps(recording);
    let mut found = Vec::new();
    if !(0..steps).any(stopped) {
        return Ok(found);
    }
    let sensors = recorded_forces(recording, experiment);
    let mut control_loop = control_loop(recording, experiment, sensors)?;
    let mut command = HandCommand::stop(recording.fingers.len());
    for step in 0..steps {
        let before = step > 0 && stopped(step - 1);
        control_loop.sense()?;
        let (touches, state) = (control_loop.touches(), control_loop.state());
        let outside = match (before, stopped(step)) {
            (true, false) => Some(Outside::Resume),
            (false, true) => {
                let controller = control_loop.controller().clone();
                let by_itself = stops(controller, touches, state, &mut command);
                (!by_itself).then_some(Outside::Stop)
            }
            _ => None,
        };
        if let Some(outside) = outside {
            outside.apply(control_loop.controller_mut());
            found.push((step, outside));
        }
        control_loop.act()?;
    }
    Ok(found)
}

/// Returns `true` if `controller` stops by itself on this input.
fn stops(
    mut controller: Controller,
    touches: &[TactileReading],
    state: &HandState,
    command: &mut HandCommand,
) -> bool {
    controller.decide(touches, state, command);
    controller.phase() == Phase::Stopped
}
