//! Valid messages, to be invalidated by tests, and inboxes that have accepted a hand, a world and a sensor program.

use feeler_link::hand::{RigSpeed, RunClock};
use feeler_link::inboxes::{Expected, HandInbox, Inbox, RigInbox, SenseInbox};
use feeler_link::messages::message::{
    CommandMessage, HandMode, Heartbeat, MessageHeader, NO_ELEMENT, NO_FINGER, PROTOCOL,
    StateMessage, TactileUpdate,
};
use feeler_link::messages::{Echo, JointCounts, Rejection, SentSteps};
use feeler_link::transport::{Topic, encode, header};
use feeler_record::wire::{Message, Vector3};

/// Instances of the programs.
pub const HAND: u64 = 1;
pub const WORLD: u64 = 2;
pub const SENSE: u64 = 3;
/// A program that has not sent a heartbeat.
pub const NOBODY: u64 = 9;

/// Number of sensing elements of the hand's only finger.
pub const ELEMENTS: usize = 3;

/// Age above which data are stale (s).
pub const STALE: f64 = 0.035;

pub fn expected() -> Expected {
    Expected {
        experiment: "ours".into(),
        fingertips: vec!["tip".into()],
        joints: JointCounts::default(),
        speed: Some(1.0),
    }
}

pub fn heartbeat(program: &str, instance: u64) -> Heartbeat {
    let is_sense = program == "sense";
    Heartbeat {
        protocol: PROTOCOL,
        instance,
        program: program.into(),
        finger: if is_sense { 0 } else { NO_FINGER },
        experiment: "ours".into(),
        fingertip: if is_sense { "tip" } else { "" }.into(),
        sequence: 1,
        speed: if program == "world" { 1.0 } else { 0.0 },
        ..Heartbeat::default()
    }
}

/// Passes `message` to `inbox` and returns the result.
pub fn put<M: Message>(
    inbox: &mut dyn Inbox,
    topic: Topic,
    message: &M,
    now: f64,
) -> Result<(), Rejection> {
    inbox.take(topic, &encode(message).unwrap(), now)
}

/// Passes a heartbeat to `inbox` and returns the result.
pub fn hear(inbox: &mut dyn Inbox, heartbeat: &Heartbeat, now: f64) -> Result<(), Rejection> {
    let place = heartbeat.place().unwrap();
    put(inbox, Topic::Heartbeat(place), heartbeat, now)
}

fn introduce(inbox: &mut dyn Inbox, programs: &[(&str, u64)]) {
    for &(program, instance) in programs {
        hear(inbox, &heartbeat(program, instance), 0.0).unwrap();
    }
}

/// Inbox of a hand with one finger, in real time, which has sent steps 1 to 100 every 10 ms until 1 s.
pub fn hand() -> HandInbox {
    hand_with(JointCounts::default())
}

/// Like [`hand`], but with these numbers of joints.
pub fn hand_with(joints: JointCounts) -> HandInbox {
    let clock = RunClock::new(RigSpeed::Times(1.0), 0.01, 3.5);
    let expected = Expected {
        joints,
        ..expected()
    };
    let mut inbox = HandInbox::new(&[ELEMENTS], clock, expected);
    introduce(&mut inbox, &[("world", WORLD), ("sense", SENSE)]);
    for step in 1..=100 {
        inbox.sent.sent(step, 0.01 * step as f64);
    }
    inbox
}

/// Inbox of a rig with one finger.
pub fn rig() -> RigInbox {
    rig_with(JointCounts::default())
}

/// Like [`rig`], but with these numbers of joints.
pub fn rig_with(joints: JointCounts) -> RigInbox {
    let expected = Expected {
        joints,
        ..expected()
    };
    let mut inbox = RigInbox::new((1, WORLD), STALE + 0.01, expected);
    introduce(&mut inbox, &[("hand", HAND), ("sense", SENSE)]);
    inbox.time = 1.0;
    inbox
}

/// Inbox of a sensor program with images of 2x1 px.
pub fn sense() -> SenseInbox {
    let mut inbox = SenseInbox::new(0, ELEMENTS, (2, 1), expected());
    introduce(&mut inbox, &[("hand", HAND), ("world", WORLD)]);
    inbox
}

/// Header that immediately echoes step 100, with its token from the hand's `sent`.
pub fn echoing(sent: &SentSteps, instance: u64, sequence: u64, stamp: f64) -> MessageHeader {
    let echo = Echo {
        step: 100,
        token: sent.token(100),
        arrived: 0.0,
    };
    MessageHeader {
        clock: WORLD,
        ..header(instance, sequence, stamp).echoing(echo, 0.0)
    }
}

pub fn state(header: MessageHeader) -> StateMessage {
    StateMessage {
        header,
        position: vec![Vector3::default()],
        velocity: vec![Vector3::default()],
        ..StateMessage::default()
    }
}

pub fn update(header: MessageHeader) -> TactileUpdate {
    TactileUpdate {
        header,
        largest_element: NO_ELEMENT,
        forces: vec![Vector3::default(); ELEMENTS],
        shear_rate: vec![0.0; ELEMENTS],
        slip_mask: vec![0],
        invalid_mask: vec![0],
        ..TactileUpdate::default()
    }
}

pub fn command(sequence: u64, velocity: f64) -> CommandMessage {
    CommandMessage {
        header: MessageHeader {
            clock: WORLD,
            ..header(HAND, sequence, 1.0)
        },
        token: sequence.wrapping_add(1000),
        state_sequence: sequence,
        joint_velocity: vec![Vector3 {
            x: velocity,
            y: 0.0,
            z: 0.0,
        }],
    }
}

pub fn mode(sequence: u64) -> HandMode {
    HandMode {
        header: header(HAND, sequence, 1.0),
        token: sequence.wrapping_add(1000),
        ..HandMode::default()
    }
}
