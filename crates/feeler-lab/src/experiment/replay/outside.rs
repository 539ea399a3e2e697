//! Who stopped the hand on record: the control law itself, or somebody outside it.
//!
//! A recording has the task's phase at every step, not who caused it. The control law as recorded stops again
//! by itself where it stopped by itself; every other stop, and every end of one, came from outside and is
//! repeated in a replay. What leaves no trace in the phase, a stop that was over before the next step, is
//! not known.

use super::{ReplayError, control_loop, recorded_forces, steps};
use crate::config::Experiment;
use feeler::control::controller::Controller;
use feeler::control::phase::Phase;
use feeler::control::stop_reason::StopReason;
use feeler::control::touch::FingerTouch;
use feeler::hand::{HandCommand, HandState};
use feeler_record::Recording;

/// What came from outside before a step's decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outside {
    Stop,
    Resume,
}

impl Outside {
    pub fn apply(self, controller: &mut Controller) {
        match self {
            Self::Stop => controller.stop(StopReason::OnRecord),
            Self::Resume => controller.resume(),
        }
    }
}

/// What came from outside on record, and before which step, in order: told by the control law of
/// `experiment`, which is to be as recorded.
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

/// Whether `controller` stops by itself on this input.
fn stops(
    mut controller: Controller,
    touches: &[FingerTouch],
    state: &HandState,
    command: &mut HandCommand,
) -> bool {
    controller.decide(touches, state, command);
    controller.phase() == Phase::Stopped
}
