//! Fingers and drives in other programs, as implementations of the control loop's traits.

use super::holds::ActiveStop;
use crate::inboxes::hand_inbox::HandInbox;
use crate::inboxes::inbox::Inbox;
use crate::messages::message::{CommandMessage, HandMode, MessageHeader, StopInForce};
use crate::transport::outlet::{Outlet, TimeSource, header, send};
use crate::transport::shared::Shared;
use crate::transport::topic::Topic;
use feeler::control::{Controller, FrameBuffer, Phase, TactileReading, TactileSource};
use feeler::hand::{Hand, HandCommand, HandError, HandState, JointEfforts, check_finger_count};
use feeler::sensor::forces::{SensorError, TactileFrame};
use std::sync::Arc;

/// Source of tactile readings for a finger whose sensor runs in another program.
pub struct RemoteFinger {
    inbox: Shared<HandInbox>,
    finger: usize,
    elements: usize,
    earlier: FrameBuffer,
    /// `true` after the first control step.
    has_begun: bool,
}

impl RemoteFinger {
    /// Creates a source for `finger`, which has `elements` elements and whose updates arrive in `inbox`.
    pub fn new(inbox: Shared<HandInbox>, finger: usize, elements: usize) -> Self {
        Self {
            inbox,
            finger,
            elements,
            earlier: FrameBuffer::default(),
            has_begun: false,
        }
    }
}

impl TactileSource for RemoteFinger {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn touch(&mut self, touch: &mut TactileReading) -> Result<(), SensorError> {
        let mut inbox = self.inbox.lock();
        let time = inbox.time_of(self.finger);
        inbox.read_frames(self.finger, &mut self.earlier);
        if !std::mem::replace(&mut self.has_begun, true) {
            // Measured while the hand waited, when the time of the run did not advance.
            self.earlier.clear();
        }
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
        (touch.frame.stamp, touch.stamp) = (time, time);
        Ok(())
    }

    fn earlier_frames(&self) -> &[TactileFrame] {
        self.earlier.as_slice()
    }
}

/// Hand whose drives and encoders are in another program.
pub struct RemoteHand {
    inbox: Shared<HandInbox>,
    outlet: Arc<dyn Outlet>,
    clock: TimeSource,
    instance: u64,
    fingers: usize,
    newest: Shared<Option<CommandMessage>>,
}

impl RemoteHand {
    /// Creates a hand with the given number of fingers, whose states arrive in `inbox`. Commands are sent through
    /// `outlet` in the name of `instance`.
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
            newest: Shared::new(None),
        }
    }

    /// Returns the last command, which is resent to a waiting rig in lockstep.
    pub(crate) fn newest_command(&self) -> Shared<Option<CommandMessage>> {
        self.newest.clone()
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
        state.stamp = inbox.state().time;
        let counts = inbox.peers().joints();
        let positions = counts.of_message(&newest.position);
        let read = positions.zip(counts.of_message(&newest.velocity));
        for (joints, (position, velocity)) in state.joints.iter_mut().zip(read) {
            (joints.position, joints.velocity) = (position, velocity);
        }
        state.efforts.fill(JointEfforts::default());
        let efforts = counts.of_message(&newest.effort);
        let efforts = efforts.zip(counts.of_message(&newest.effort_uncertainty));
        for (own, (effort, uncertainty)) in state.efforts.iter_mut().zip(efforts) {
            *own = JointEfforts {
                effort,
                uncertainty,
            };
        }
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        check_finger_count(self.fingers, command.joint_velocity().len())?;
        let message = {
            let mut inbox = self.inbox.lock();
            let velocities = command.joint_velocity().iter().copied();
            let joint_velocity = inbox.peers().joints().to_message(velocities)?;
            let (time, clock) = (inbox.state().time, &inbox.state().clock);
            let fingers = (0..self.fingers).map(|finger| inbox.time_of(finger));
            // The rig checks the age of the data on its own clock.
            let (stamp, clock) = (clock.to_rig(fingers.fold(time, f64::min)), clock.clock());
            let sequence = inbox.state_sequence();
            let (step, token) = next_step(&mut inbox, &self.clock);
            CommandMessage {
                header: MessageHeader {
                    clock: clock.unwrap_or_default(),
                    ..header(self.instance, step, stamp)
                },
                token,
                state_sequence: sequence,
                joint_velocity,
            }
        };
        let sent = send(&*self.outlet, Topic::Command, &message);
        *self.newest.lock() = Some(message);
        // Wakes `Stopper::stop`, which waits for the next step.
        self.inbox.changed();
        sent.map_err(|e| HandError::Failed(e.to_string()))
    }
}

/// Starts the next control step and returns its number and token.
fn next_step(inbox: &mut HandInbox, clock: &TimeSource) -> (u64, u64) {
    let step = inbox.sent.newest() + 1;
    inbox.sent.sent(step, clock());
    (step, inbox.sent.token(step))
}

/// Returns the mode message for the latest control step.
pub fn mode_of(inbox: &HandInbox, controller: &Controller, instance: u64, stamp: f64) -> HandMode {
    let (phase, step) = (controller.phase(), inbox.sent.newest());
    HandMode {
        header: header(instance, step, stamp),
        token: inbox.sent.token(step),
        search: phase == Phase::Search,
        r#move: phase == Phase::Move,
        phase: phase.into(),
        stroke: controller.task().stroke(),
        stopped: controller
            .stop_reason()
            .map_or(String::new(), ToString::to_string),
        stops: stops(inbox),
    }
}

fn stops(inbox: &HandInbox) -> Vec<StopInForce> {
    let in_force = inbox.holds.in_force().iter();
    in_force.map(ActiveStop::to_message).collect()
}

/// Starts a step without a command, while the hand waits for other programs, and returns its mode message.
pub fn waiting_mode(inbox: &mut HandInbox, clock: &TimeSource, instance: u64) -> HandMode {
    let (step, token) = next_step(inbox, clock);
    HandMode {
        header: header(instance, step, 0.0),
        token,
        phase: Phase::Search.into(),
        stops: stops(inbox),
        ..HandMode::default()
    }
}
