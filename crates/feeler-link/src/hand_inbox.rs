//! What the hand program has heard: forces and flags, joint angles, other programs, orders.

use super::freshness::SentSteps;
use super::holds::Holds;
use super::inbox::{Inbox, read};
use super::message::{
    MessageHeader, NO_FINGER, ProgramKind, ResumeMessage, StateMessage, StopMessage, TactileUpdate,
};
use super::peers::{Expected, Peers};
use super::plausible::{check_protocol, check_state, check_update};
use super::rejection::{Rejection, Rejections};
use super::run_clock::RunClock;
use super::sequence::Sequence;
use super::topic::Topic;
use feeler::control::flags::FingerFlags;
use feeler_record::wire::message;
use serde::{Deserialize, Serialize};

/// Everything that has arrived for the hand. Bytes and the hand's clock in, decisions out.
#[derive(Debug, Clone)]
pub struct HandInbox {
    fingers: Vec<FingerInbox>,
    state: StateInbox,
    peers: Peers,
    /// What was not taken.
    pub rejected: Rejections,
    /// When the control steps were sent.
    pub sent: SentSteps,
    /// The stops in force.
    pub holds: Holds,
    /// Number of the state that was answered last, where a hand waits for all of the next: it is not woken for each part.
    pub(crate) answered: Option<u64>,
}

/// What has arrived of one finger.
#[derive(Debug, Clone, Default)]
pub struct FingerInbox {
    /// The newest update; none before the first.
    pub newest: Option<TactileUpdate>,
    /// Updates that never came, by their numbers.
    pub lost: u64,
    elements: usize,
    sequence: Sequence,
    /// The earliest time at which it can have been taken, s on the hand's clock.
    earliest: f64,
    /// Its time in the run, s; none where it is stamped by a clock of its own.
    time: Option<f64>,
    /// Flags of all updates since they were last taken.
    flags: Option<FingerFlags>,
}

/// What has arrived of the joints.
#[derive(Debug, Clone)]
pub struct StateInbox {
    /// The newest state; none before the first.
    pub newest: Option<StateMessage>,
    /// Its time in the run, s.
    pub time: f64,
    /// States that never came, by their numbers.
    pub lost: u64,
    /// Maps the rig's stamps onto the time of the run.
    pub clock: RunClock,
    sequence: Sequence,
    /// The earliest time at which it can have been taken, s on the hand's clock.
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

/// How a stop begins in every version.
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

/// Reads a stop of whatever version: that it is to stop is all that counts.
fn read_stop(bytes: &[u8]) -> Result<StopMessage, Rejection> {
    read(bytes).or_else(|_| {
        let EarlierStop { protocol, from } = read(bytes)?;
        let id = 0;
        Ok(StopMessage { protocol, from, id })
    })
}

impl HandInbox {
    /// Nothing has arrived yet for a hand whose fingers have so many `elements` and whose rig's time goes as `clock`
    /// says; programs must agree with `expected`.
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
            holds: Holds::default(),
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
        let number = (header.instance, header.sequence);
        let lost = inbox.sequence.missing(number, now)?;
        let earliest = earliest(&self.sent, header, now)?;
        let time = match header.clock == header.instance {
            // A camera's own clock says nothing; when it was is known as well as its age is.
            true => None,
            false => {
                let clock = &self.state.clock;
                Some(clock.of_rig(header.clock, header.stamp, header.sequence)?)
            }
        };
        inbox.earliest = not_before(&inbox.sequence, number, inbox.earliest, earliest);
        inbox.sequence.take(number, now);
        inbox.lost = inbox.lost.saturating_add(lost);
        inbox.time = time;
        let flags = flags(&update);
        inbox.flags = Some(inbox.flags.map_or(flags, |before| before.then(flags)));
        inbox.newest = Some(update);
        Ok(())
    }

    fn take_state(&mut self, state: StateMessage, now: f64) -> Result<(), Rejection> {
        let header = state.header;
        check_state(self.fingers.len(), &state)?;
        self.peers
            .check(header.instance, &ProgramKind::World, NO_FINGER)?;
        let inbox = &mut self.state;
        let number = (header.instance, header.sequence);
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

    /// The fingers.
    pub fn fingers(&self) -> &[FingerInbox] {
        &self.fingers
    }

    /// One finger, to take what it felt.
    pub fn finger_mut(&mut self, finger: usize) -> Option<&mut FingerInbox> {
        self.fingers.get_mut(finger)
    }

    /// The joints.
    pub fn state(&self) -> &StateInbox {
        &self.state
    }

    /// Number of the newest state; 0 before the first.
    pub fn state_sequence(&self) -> u64 {
        let state = self.state.newest.as_ref();
        state.map_or(0, |state| state.header.sequence)
    }

    /// Whether a state after that of the number `answered` has come, and what all fingers felt then.
    pub fn is_whole_after(&self, answered: u64) -> bool {
        let state = self.state_sequence();
        let felt = |finger: &FingerInbox| {
            let update = finger.newest.as_ref();
            update.is_some_and(|update| update.header.sequence == state)
        };
        state > answered && self.fingers.iter().all(felt)
    }

    /// When the newest update of `finger` was taken, s of the run's time. Of a camera with a clock of its own, that is
    /// as much later than the newest state as it can have been, by the bounds of both ages.
    pub fn time_of(&self, finger: usize) -> f64 {
        let state = &self.state;
        let Some(inbox) = self.fingers.get(finger) else {
            return state.time;
        };
        let speed = state.clock.speed().times();
        let later = (inbox.earliest - state.earliest) * speed;
        let of_own_clock = || state.time + if later.is_finite() { later } else { 0.0 };
        inbox.time.unwrap_or_else(of_own_clock).max(0.0)
    }

    /// Upper bounds of the ages of the joint state and of each finger's forces at `now`, s; infinite where
    /// nothing is known.
    pub fn ages(&self, now: f64) -> (f64, impl Iterator<Item = f64>) {
        let fingers = self.fingers.iter().map(move |finger| now - finger.earliest);
        (now - self.state.earliest, fingers)
    }
}

impl FingerInbox {
    /// The flags of all updates since they were last taken; where there was none, those of the newest.
    pub fn take_flags(&mut self) -> FingerFlags {
        let newest = || self.newest.as_ref().map(flags);
        self.flags.take().or_else(newest).unwrap_or_default()
    }
}

/// The flags of an update.
pub(super) fn flags(update: &TactileUpdate) -> FingerFlags {
    let element = usize::try_from(update.largest_element).ok();
    FingerFlags {
        touch: update.touch,
        slip: update.slip,
        over: update.over,
        largest_element: element.filter(|&element| element < update.forces.len()),
        grasp_force: update.grasp_force,
    }
}

/// The earliest time of a program's data: nothing that it tells is older than what it told before; what another
/// told says nothing of its data.
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

/// The earliest time at which what a message of `header` tells can have been.
///
/// # Errors
/// When it is not known: the message echoes no step of this hand's run that is remembered.
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
    // Clocks that run at slightly different rates may put it after its own arrival.
    Ok(earliest.min(now))
}
