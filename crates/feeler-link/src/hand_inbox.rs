//! What the hand program has heard: forces and flags, joint angles, other programs, orders.

use super::freshness::SentSteps;
use super::inbox::{Inbox, read};
use super::message::{
    MessageHeader, NO_FINGER, PROTOCOL, ProgramKind, ResumeMessage, StateMessage, StopMessage,
    TactileUpdate,
};
use super::peers::{Expected, Peers};
use super::rejection::{Rejection, Rejections};
use super::topic::Topic;
use feeler::control::flags::FingerFlags;
use feeler::control::stop_reason::StopReason;
use feeler_record::wire::Vector3;

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
    /// Who told the hand to stop, since that was last asked.
    stop: Option<String>,
    /// Whether it was told to go on since.
    resume: bool,
}

/// What has arrived of one finger.
#[derive(Debug, Clone, Default)]
pub struct FingerInbox {
    /// The newest update; none before the first.
    pub newest: Option<TactileUpdate>,
    /// Updates that never came, by their numbers.
    pub lost: u64,
    elements: usize,
    earliest: f64,
    /// Flags of all updates since they were last taken.
    flags: Option<FingerFlags>,
}

/// What has arrived of the joints.
#[derive(Debug, Clone, Default)]
pub struct StateInbox {
    /// The newest state; none before the first.
    pub newest: Option<StateMessage>,
    /// States that never came, by their numbers.
    pub lost: u64,
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
            Topic::Heartbeat => self.peers.heard(bytes, now).map(|_| ()),
            Topic::Stop => {
                let stop: StopMessage = read(bytes)?;
                // Of whatever version: that it is to stop is all that counts.
                self.stop = Some(stop.from);
                self.resume = false;
                Ok(())
            }
            Topic::Resume => {
                let resume: ResumeMessage = read(bytes)?;
                check_protocol(resume.protocol)?;
                self.resume = true;
                Ok(())
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
}

impl HandInbox {
    /// Nothing has arrived yet for a hand whose fingers have so many `elements`; programs must agree
    /// with `expected`.
    pub fn new(elements: &[usize], expected: Expected) -> Self {
        let finger = |&elements: &usize| FingerInbox {
            elements,
            earliest: f64::NEG_INFINITY,
            ..FingerInbox::default()
        };
        Self {
            fingers: elements.iter().map(finger).collect(),
            state: StateInbox {
                earliest: f64::NEG_INFINITY,
                ..StateInbox::default()
            },
            peers: Peers::new(expected),
            rejected: Rejections::default(),
            sent: SentSteps::default(),
            stop: None,
            resume: false,
        }
    }

    fn take_update(
        &mut self,
        finger: usize,
        update: TactileUpdate,
        now: f64,
    ) -> Result<(), Rejection> {
        let header = update.header;
        check_protocol(header.protocol)?;
        let inbox = self.fingers.get_mut(finger).ok_or(Rejection::Size)?;
        check_update(finger, inbox.elements, &update)?;
        (self.peers).check(header.instance, &ProgramKind::Sense, update.finger)?;
        let before = inbox.newest.as_ref().map(|newest| newest.header);
        let before = (before, inbox.earliest);
        let (lost, earliest) = follow(before, header, &self.sent, now)?;
        inbox.lost = inbox.lost.saturating_add(lost);
        inbox.earliest = earliest;
        let flags = flags(&update);
        inbox.flags = Some(inbox.flags.map_or(flags, |before| before.then(flags)));
        inbox.newest = Some(update);
        Ok(())
    }

    fn take_state(&mut self, state: StateMessage, now: f64) -> Result<(), Rejection> {
        let header = state.header;
        check_protocol(header.protocol)?;
        check_state(self.fingers.len(), &state)?;
        self.peers
            .check(header.instance, &ProgramKind::World, NO_FINGER)?;
        let before = self.state.newest.as_ref().map(|newest| newest.header);
        let before = (before, self.state.earliest);
        let (lost, earliest) = follow(before, header, &self.sent, now)?;
        self.state.lost = self.state.lost.saturating_add(lost);
        self.state.earliest = earliest;
        self.state.newest = Some(state);
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

    /// How much later (s) the newest update of `finger` can have been taken than the newest joint state,
    /// by the bounds of both.
    pub fn later_than_state(&self, finger: usize) -> f64 {
        let earliest = self
            .fingers
            .get(finger)
            .map_or(f64::NEG_INFINITY, |f| f.earliest);
        earliest - self.state.earliest
    }

    /// Upper bounds of the ages of the joint state and of each finger's forces at `now`, s; infinite where
    /// nothing is known.
    pub fn ages(&self, now: f64) -> (f64, impl Iterator<Item = f64>) {
        let fingers = self.fingers.iter().map(move |finger| now - finger.earliest);
        (now - self.state.earliest, fingers)
    }

    /// Why the hand must stop at `now` (s): told to, or because of data older than `limit`, s.
    pub fn fault(&mut self, now: f64, limit: f64) -> Option<StopReason> {
        if let Some(by) = self.stop.take() {
            return Some(StopReason::Told { by });
        }
        let (state, mut fingers) = self.ages(now);
        let old = |age: f64| age.is_nan() || age > limit;
        if old(state) {
            return Some(StopReason::StaleState { age: state, limit });
        }
        let finger = fingers.position(old)?;
        let age = now - self.fingers[finger].earliest;
        Some(StopReason::StaleForces { finger, age, limit })
    }

    /// Whether the hand was told to go on since this was last asked.
    pub fn take_resume(&mut self) -> bool {
        std::mem::take(&mut self.resume)
    }
}

impl FingerInbox {
    /// The flags of all updates since they were last taken; where there was none, those of the newest.
    pub fn take_flags(&mut self) -> FingerFlags {
        let newest = || self.newest.as_ref().map(flags);
        self.flags.take().or_else(newest).unwrap_or_default()
    }
}

/// Holds an update to a `finger` of so many `elements`.
pub(super) fn check_update(
    finger: usize,
    elements: usize,
    update: &TactileUpdate,
) -> Result<(), Rejection> {
    let mask = elements.div_ceil(8);
    let sizes = usize::try_from(update.finger) == Ok(finger)
        && update.forces.len() == elements
        && update.shear_rate.len() == elements
        && update.slip_mask.len() == mask
        && update.invalid_mask.len() == mask;
    if !sizes {
        return Err(Rejection::Size);
    }
    let forces = update.forces.iter().map(sum);
    let numbers = forces.chain(update.shear_rate.iter().copied());
    let header = update.header;
    check_finite(numbers.chain([header.stamp, header.echo_age, update.grasp_force]))
}

/// Holds a state to a hand of so many `fingers`.
pub(super) fn check_state(fingers: usize, state: &StateMessage) -> Result<(), Rejection> {
    let joints = [state.position.len(), state.velocity.len()];
    if joints != [fingers; 2] || state.instruments.len() > 1 {
        return Err(Rejection::Size);
    }
    let measured = state.instruments.iter().flat_map(|i| {
        let centre = sum(&i.cap_centre);
        [
            i.torque,
            i.bridge_voltage,
            i.cap_angle,
            centre,
            i.cap_torque,
            i.slipped.iter().sum(),
        ]
    });
    let joints = state.position.iter().chain(&state.velocity).map(sum);
    let header = state.header;
    check_finite(
        joints
            .chain(measured)
            .chain([header.stamp, header.echo_age]),
    )
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

fn sum(v: &Vector3) -> f64 {
    v.x + v.y + v.z
}

fn check_finite(mut numbers: impl Iterator<Item = f64>) -> Result<(), Rejection> {
    let finite = numbers.all(f64::is_finite);
    finite.then_some(()).ok_or(Rejection::NotFinite)
}

pub(super) fn check_protocol(protocol: u32) -> Result<(), Rejection> {
    let same = protocol == PROTOCOL;
    same.then_some(()).ok_or(Rejection::Protocol)
}

/// How many messages are missing between that of the header `before` and that of `header`, and the
/// earliest time of what the latter tells. A program tells nothing older than it told before; what another
/// told says nothing of its data.
fn follow(
    (before, earliest_before): (Option<MessageHeader>, f64),
    header: MessageHeader,
    sent: &SentSteps,
    now: f64,
) -> Result<(u64, f64), Rejection> {
    let earliest = earliest(sent, header, now)?;
    match before.filter(|before| before.instance == header.instance) {
        Some(before) if header.sequence <= before.sequence => Err(Rejection::Old),
        Some(before) => {
            let lost = header.sequence - before.sequence - 1;
            Ok((lost, earliest.max(earliest_before)))
        }
        None => Ok((0, earliest)),
    }
}

/// The earliest time at which what a message of `header` tells can have been; none known is long ago.
fn earliest(sent: &SentSteps, header: MessageHeader, now: f64) -> Result<f64, Rejection> {
    if header.echo_step > sent.newest() {
        return Err(Rejection::Future);
    }
    let earliest = sent.earliest(header.echo_step, header.echo_age);
    // Clocks that run at slightly different rates may put it after its own arrival.
    Ok(earliest.map_or(f64::NEG_INFINITY, |earliest| earliest.min(now)))
}
