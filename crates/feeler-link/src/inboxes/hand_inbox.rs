//! Messages received by the hand program: forces and flags, joint states, heartbeats and orders.

use super::inbox::Inbox;
use super::peers::{Expected, Peers};
use crate::hand::holds::ActiveStops;
use crate::hand::run_clock::RunClock;
use crate::messages::decode::read;
use crate::messages::freshness::SentSteps;
use crate::messages::message::{
    MessageHeader, NO_FINGER, ProgramKind, ResumeMessage, StateMessage, StopMessage, TactileUpdate,
};
use crate::messages::plausible::{check_protocol, check_state, check_update};
use crate::messages::rejection::{Rejection, Rejections};
use crate::messages::sequence::Sequence;
use crate::transport::topic::Topic;
use feeler::control::{FingerFlags, FrameBuffer};
use feeler_record::wire::message;
use serde::{Deserialize, Serialize};

/// Inbox of the hand: validates received messages and keeps the latest data. Performs no I/O; times are passed as
/// arguments.
#[derive(Debug, Clone)]
pub struct HandInbox {
    fingers: Vec<FingerInbox>,
    state: StateInbox,
    peers: Peers,
    /// Counters of rejected messages.
    pub rejected: Rejections,
    /// Send times of the control steps.
    pub sent: SentSteps,
    /// Active stops.
    pub holds: ActiveStops,
    /// In lockstep, the sequence number of the last answered state. Waiting threads are woken only when the next state
    /// and the forces of all fingers have arrived.
    pub(crate) answered: Option<u64>,
}

/// Data received for one finger.
#[derive(Debug, Clone, Default)]
pub struct FingerInbox {
    /// Latest update, or `None` before the first.
    pub newest: Option<TactileUpdate>,
    /// Number of lost updates, from gaps in sequence numbers.
    pub lost: u64,
    /// Frames of the updates since the last [`read_frames`](HandInbox::read_frames), except the latest.
    earlier: FrameBuffer,
    /// `true` if the latest update has not been read yet.
    is_unread: bool,
    elements: usize,
    sequence: Sequence,
    /// Earliest possible measurement time of the latest update (s, on the hand's clock).
    earliest: f64,
    /// Time of the latest update on the run's clock (s), or `None` if it is stamped by the sensor's clock.
    time: Option<f64>,
    /// Combined flags of all updates since the last [`take_flags`](Self::take_flags).
    flags: Option<FingerFlags>,
}

/// Joint states received from the rig.
#[derive(Debug, Clone)]
pub struct StateInbox {
    /// Latest state, or `None` before the first.
    pub newest: Option<StateMessage>,
    /// Time of the latest state on the run's clock (s).
    pub time: f64,
    /// Number of lost states, from gaps in sequence numbers.
    pub lost: u64,
    /// Converts the rig's stamps to run time.
    pub clock: RunClock,
    sequence: Sequence,
    /// Earliest possible measurement time of the latest state (s, on the hand's clock).
    earliest: f64,
}

impl Inbox for HandInbox {
    fn take_in(&mut self, topic: Topic, bytes: &[u8], now: f64) -> Result<(), Rejection> {
        match topic {
            Topic::Tactile(finger) => {
                let update: TactileUpdate = read(bytes)?;
                self.take_update(finger, update, now)
            }
            Topic::State => {
                let state: StateMessage = read(bytes)?;
                self.take_state(state, now)
            }
            Topic::Heartbeat(place) => self.peers.heard(place, bytes, now).map(|_| ()),
            Topic::Stop => {
                let stop = read_stop(bytes)?;
                self.holds.order(stop.id, &stop.from);
                Ok(())
            }
            Topic::Resume => {
                let resume: ResumeMessage = read(bytes)?;
                check_protocol(resume.protocol)?;
                let was_in_force = self.holds.resume(resume.number);
                was_in_force.then_some(()).ok_or(Rejection::Old)
            }
            _ => Err(Rejection::Stranger),
        }
    }

    fn peers(&self) -> &Peers {
        &self.peers
    }

    fn rejected(&mut self) -> &mut Rejections {
        &mut self.rejected
    }

    fn is_worth_waking(&self) -> bool {
        (self.answered).is_none_or(|answered| self.is_whole_after(answered))
    }
}

/// Leading fields of a stop order, common to all versions.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct EarlierStop {
    protocol: u32,
    from: String,
}

message!(
    EarlierStop,
    "Stop",
    "# How a stop begins in every version",
    "uint32 protocol",
    "string from",
);

/// Decodes a stop order of any version, because a stop must always take effect.
fn read_stop(bytes: &[u8]) -> Result<StopMessage, Rejection> {
    read(bytes).or_else(|_| {
        let EarlierStop { protocol, from } = read(bytes)?;
        let id = 0;
        Ok(StopMessage { protocol, from, id })
    })
}

impl HandInbox {
    /// Creates an empty inbox. `elements` is the number of elements of each finger, `clock` converts the rig's stamps
    /// to run time, and other programs must match `expected`.
    pub fn new(elements: &[usize], clock: RunClock, expected: Expected) -> Self {
        let finger = |&elements: &usize| FingerInbox {
            elements,
            earliest: f64::NEG_INFINITY,
            ..FingerInbox::default()
        };
        Self {
            fingers: elements.iter().map(finger).collect(),
            state: StateInbox {
                newest: None,
                time: 0.0,
                lost: 0,
                clock,
                sequence: Sequence::default(),
                earliest: f64::NEG_INFINITY,
            },
            peers: Peers::new(expected),
            rejected: Rejections::default(),
            sent: SentSteps::default(),
            holds: ActiveStops::default(),
            answered: None,
        }
    }

    fn take_update(
        &mut self,
        finger: usize,
        update: TactileUpdate,
        now: f64,
    ) -> Result<(), Rejection> {
        let header = update.header;
        let inbox = self.fingers.get_mut(finger).ok_or(Rejection::Size)?;
        check_update(finger, inbox.elements, &update)?;
        (self.peers).check(header.instance, &ProgramKind::Sense, update.finger)?;
        let number = header.number();
        let lost = inbox.sequence.missing(number, now)?;
        let earliest = earliest(&self.sent, header, now)?;
        let time = match header.clock == header.instance {
            // The stamp of a sensor's own clock is not comparable; only the bound of the age is known.
            true => None,
            false => {
                let clock = &self.state.clock;
                Some(clock.of_rig(header.clock, header.stamp, header.sequence)?)
            }
        };
        inbox.keep_unread(&self.state, &update);
        inbox.earliest = not_before(&inbox.sequence, number, inbox.earliest, earliest);
        inbox.sequence.take(number, now);
        inbox.lost = inbox.lost.saturating_add(lost);
        inbox.time = time;
        let flags = flags(&update);
        inbox.flags = Some(inbox.flags.map_or(flags, |before| before.then(flags)));
        inbox.newest = Some(update);
        inbox.is_unread = true;
        Ok(())
    }

    fn take_state(&mut self, state: StateMessage, now: f64) -> Result<(), Rejection> {
        let header = state.header;
        check_state(self.fingers.len(), self.peers.joints(), &state)?;
        self.peers
            .check(header.instance, &ProgramKind::World, NO_FINGER)?;
        let inbox = &mut self.state;
        let number = header.number();
        let lost = inbox.sequence.missing(number, now)?;
        let earliest = earliest(&self.sent, header, now)?;
        let earliest = not_before(&inbox.sequence, number, inbox.earliest, earliest);
        inbox.time = inbox.clock.take(header, earliest, now)?;
        inbox.earliest = earliest;
        inbox.sequence.take(number, now);
        inbox.lost = inbox.lost.saturating_add(lost);
        inbox.newest = Some(state);
        Ok(())
    }

    /// Returns the data of all fingers.
    pub fn fingers(&self) -> &[FingerInbox] {
        &self.fingers
    }

    /// Returns the data of one finger, to take its flags.
    pub fn finger_mut(&mut self, finger: usize) -> Option<&mut FingerInbox> {
        self.fingers.get_mut(finger)
    }

    /// Returns the joint states.
    pub fn state(&self) -> &StateInbox {
        &self.state
    }

    /// Returns the number of the latest state, or 0 before the first.
    pub fn state_sequence(&self) -> u64 {
        let state = self.state.newest.as_ref();
        state.map_or(0, |state| state.header.sequence)
    }

    /// Returns `true` if a state newer than number `answered` and the matching updates of all fingers have arrived.
    pub fn is_whole_after(&self, answered: u64) -> bool {
        let state = self.state_sequence();
        let felt = |finger: &FingerInbox| {
            let update = finger.newest.as_ref();
            update.is_some_and(|update| update.header.sequence == state)
        };
        state > answered && self.fingers.iter().all(felt)
    }

    /// Returns the time of the latest update of `finger` on the run's clock (s). For a sensor with a separate clock, it
    /// is estimated relative to the latest state from the earliest possible measurement times of both.
    pub fn time_of(&self, finger: usize) -> f64 {
        let finger = self.fingers.get(finger);
        finger.map_or(self.state.time, |finger| finger.time_of(&self.state))
    }

    /// Marks the latest update of `finger` as read, and exchanges `frames` for the frames of the updates between this one
    /// and the one that was read before.
    pub fn read_frames(&mut self, finger: usize, frames: &mut FrameBuffer) {
        frames.clear();
        if let Some(finger) = self.fingers.get_mut(finger) {
            std::mem::swap(&mut finger.earlier, frames);
            finger.is_unread = false;
        }
    }

    /// Returns upper bounds of the ages of the joint state and of each finger's forces at `now` (s). Infinite if no
    /// data has arrived.
    pub fn ages(&self, now: f64) -> (f64, impl Iterator<Item = f64>) {
        let fingers = self.fingers.iter().map(move |finger| now - finger.earliest);
        (now - self.state.earliest, fingers)
    }
}

impl FingerInbox {
    /// Returns the time of the latest update on the run's clock (s), as in [`HandInbox::time_of`].
    fn time_of(&self, state: &StateInbox) -> f64 {
        self.measured_at(state).max(0.0)
    }

    /// Returns the time of the latest update on the run's clock (s), negative if it was measured before the start of
    /// the run.
    fn measured_at(&self, state: &StateInbox) -> f64 {
        let later = (self.earliest - state.earliest) * state.clock.speed().times();
        let of_own_clock = || state.time + if later.is_finite() { later } else { 0.0 };
        self.time.unwrap_or_else(of_own_clock)
    }

    /// Keeps the frame of the latest update if it was measured during the run and has not been read, and `next`
    /// contains another frame.
    fn keep_unread(&mut self, state: &StateInbox, next: &TactileUpdate) {
        let time = self.measured_at(state);
        if time < 0.0 {
            return;
        }
        let unread = self.newest.as_ref().filter(|_| self.is_unread);
        if let Some(update) = unread.filter(|update| update.frame != next.frame) {
            self.earlier.push(update.frame, time, update.valid_forces());
        }
    }

    /// Returns the combined flags of all updates since the last call, or the flags of the latest update if there was no
    /// new one.
    pub fn take_flags(&mut self) -> FingerFlags {
        let newest = || self.newest.as_ref().map(flags);
        self.flags.take().or_else(newest).unwrap_or_default()
    }
}

/// Returns the flags of an update.
pub(crate) fn flags(update: &TactileUpdate) -> FingerFlags {
    let element = usize::try_from(update.largest_element).ok();
    FingerFlags {
        touch: update.touch,
        slip: update.slip,
        over: update.over,
        largest_element: element.filter(|&element| element < update.forces.len()),
        grasp_force: update.grasp_force,
    }
}

/// Returns the earliest possible measurement time of a message, and at least that of the previous message if both are
/// from the same program, because a program sends its data in order.
fn not_before(
    before: &Sequence,
    (instance, _): (u64, u64),
    earliest_before: f64,
    earliest: f64,
) -> f64 {
    match before.newest() {
        Some((same, _)) if same == instance => earliest.max(earliest_before),
        _ => earliest,
    }
}

/// Returns the earliest possible measurement time of a message.
///
/// # Errors
/// If the message does not echo a recent step of this hand's run.
fn earliest(sent: &SentSteps, header: MessageHeader, now: f64) -> Result<f64, Rejection> {
    match header.echo_step {
        0 => return Err(Rejection::Unintroduced),
        step if step > sent.newest() => return Err(Rejection::Future),
        _ => {}
    }
    let echo = (header.echo_step, header.echo_token);
    let earliest = sent
        .earliest(echo, header.echo_age)
        .ok_or(Rejection::Unproven)?;
    // Clock drift may put the time after the arrival.
    Ok(earliest.min(now))
}
