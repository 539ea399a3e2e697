//! Fingers and a hand in other programs, behind the seams of the control loop.

use super::hand_inbox::HandInbox;
use super::message::{CommandMessage, HandMode, MessageHeader};
use super::outlet::{Outlet, TimeSource, header, send};
use super::shared::Shared;
use super::topic::Topic;
use feeler::control::controller::Controller;
use feeler::control::phase::Phase;
use feeler::control::touch::{FingerTouch, TouchSource};
use feeler::hand::{Hand, HandCommand, HandError, HandState, check_finger_count};
use feeler::sensor::reading::SensorError;
use feeler_record::wire::Vector3;
use std::sync::Arc;

/// A finger that another program senses.
pub struct RemoteFinger {
    inbox: Shared<HandInbox>,
    finger: usize,
    elements: usize,
}

impl RemoteFinger {
    /// The finger, of `elements` elements, whose updates arrive in `inbox`.
    pub fn new(inbox: Shared<HandInbox>, finger: usize, elements: usize) -> Self {
        Self {
            inbox,
            finger,
            elements,
        }
    }
}

impl TouchSource for RemoteFinger {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn touch(&mut self, touch: &mut FingerTouch) -> Result<(), SensorError> {
        let mut inbox = self.inbox.lock();
        let rig = inbox.state().newest.as_ref().map(|state| state.header);
        let later = inbox.later_than_state(self.finger);
        let Some(finger) = inbox.finger_mut(self.finger) else {
            return Ok(());
        };
        let flags = finger.take_flags();
        let Some(update) = &finger.newest else {
            return Ok(());
        };
        let (expected, actual) = (touch.frame.forces.len(), update.forces.len());
        if actual != expected {
            return Err(SensorError::ElementCount { expected, actual });
        }
        for (force, sent) in touch.frame.forces.iter_mut().zip(update.valid_forces()) {
            *force = sent;
        }
        touch.shear_rate.copy_from_slice(&update.shear_rate);
        touch.flags = flags;
        touch.frame.sequence = update.frame;
        touch.frame.stamp = on_rigs_clock(update.header, rig, later);
        touch.stamp = touch.frame.stamp;
        Ok(())
    }
}

/// The stamp of `header` on the clock of the rig's newest header, s. Where that is another clock, what is
/// known is only how much `later` than the rig's state it can have been.
fn on_rigs_clock(header: MessageHeader, rig: Option<MessageHeader>, later: f64) -> f64 {
    match rig {
        Some(rig) if rig.clock != header.clock => rig.stamp + later,
        _ => header.stamp,
    }
}

/// A hand whose drives and encoders are in another program.
pub struct RemoteHand {
    inbox: Shared<HandInbox>,
    outlet: Arc<dyn Outlet>,
    clock: TimeSource,
    instance: u64,
    fingers: usize,
}

impl RemoteHand {
    /// The hand of `fingers` whose states arrive in `inbox`; `instance` commands it through `outlet`.
    pub fn new(
        inbox: Shared<HandInbox>,
        outlet: Arc<dyn Outlet>,
        clock: TimeSource,
        (instance, fingers): (u64, usize),
    ) -> Self {
        Self {
            inbox,
            outlet,
            clock,
            instance,
            fingers,
        }
    }
}

impl Hand for RemoteHand {
    fn finger_count(&self) -> usize {
        self.fingers
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        check_finger_count(self.fingers, state.joints.len())?;
        let inbox = self.inbox.lock();
        let Some(newest) = &inbox.state().newest else {
            return Ok(());
        };
        state.stamp = newest.header.stamp;
        let read = newest.position.iter().zip(&newest.velocity);
        for (joints, (&position, &velocity)) in state.joints.iter_mut().zip(read) {
            joints.position = position.into();
            joints.velocity = velocity.into();
        }
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        check_finger_count(self.fingers, command.joint_velocity().len())?;
        let message = {
            let mut inbox = self.inbox.lock();
            let state = inbox.state().newest.as_ref().map(|state| state.header);
            let state = state.unwrap_or_default();
            let oldest = (0..self.fingers).filter_map(|finger| {
                let update = inbox.fingers().get(finger)?.newest.as_ref()?;
                let later = inbox.later_than_state(finger);
                Some(on_rigs_clock(update.header, Some(state), later))
            });
            let stamp = oldest.fold(state.stamp, f64::min);
            let step = next_step(&mut inbox, &self.clock);
            CommandMessage {
                header: MessageHeader {
                    clock: state.clock,
                    ..header(self.instance, step, stamp)
                },
                state_sequence: state.sequence,
                joint_velocity: command
                    .joint_velocity()
                    .iter()
                    .map(|&v| Vector3::from(v))
                    .collect(),
            }
        };
        send(&*self.outlet, Topic::Command, &message).map_err(|e| HandError::Failed(e.to_string()))
    }
}

/// The number of the control step that begins now.
fn next_step(inbox: &mut HandInbox, clock: &TimeSource) -> u64 {
    let step = inbox.sent.newest() + 1;
    inbox.sent.sent(step, clock());
    step
}

/// What the hand is about in the control step whose command was sent last.
pub fn mode_of(inbox: &HandInbox, controller: &Controller, instance: u64, stamp: f64) -> HandMode {
    let phase = controller.phase();
    HandMode {
        header: header(instance, inbox.sent.newest(), stamp),
        search: phase == Phase::Search,
        r#move: phase == Phase::Move,
        phase: phase.into(),
        stroke: controller.task().stroke(),
        stopped: controller
            .stop_reason()
            .map_or(String::new(), ToString::to_string),
    }
}

/// A step in which the hand commands nothing: it waits for the other programs.
pub fn waiting_mode(inbox: &mut HandInbox, clock: &TimeSource, instance: u64) -> HandMode {
    let step = next_step(inbox, clock);
    HandMode {
        header: header(instance, step, 0.0),
        phase: Phase::Search.into(),
        ..HandMode::default()
    }
}
