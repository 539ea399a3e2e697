//! What only the simulator knows of a run: for whoever judges it, never for the hand.

use super::Session;
use crate::sim::object::Motion;

/// What came of a run so far, in truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Torque that the cap is tightened to, N·m: what its thread now holds against being turned on. None
    /// without a cap.
    pub cap_torque: Option<f64>,
    /// Work that friction took from feelers that slipped, J.
    pub slip_work: f64,
}

impl Truth {
    /// What came of `session` so far.
    pub fn of(session: &Session) -> Self {
        let world = session.rig().world();
        let (model, state) = (world.model(), world.state());
        let cap = session.cap.and_then(|cap| {
            let (object, state) = (model.objects.get(cap)?, state.objects.get(cap)?);
            match &object.motion {
                Motion::Turns(hinge) => Some(hinge.thread.resisting_torque(state.turn.angle)),
                Motion::Fixed | Motion::Free(_) => None,
            }
        });
        Self {
            cap_torque: cap,
            slip_work: state.slip_work(),
        }
    }
}
