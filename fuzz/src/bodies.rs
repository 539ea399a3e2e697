//! What each fuzz target does with its bytes: reads them and, if they are sound, uses what was read.
//!
//! Shared by the targets and by `tests/fuzz_corpus.rs`, so that every test run goes through the
//! corpora. A target says whether its bytes were sound.

use feeler::hand::{Hand, HandState};
use feeler::sensor::calibration::Calibration;
use feeler::sensor::camera::{Camera, CameraError};
use feeler::sensor::frame::Frame;
use feeler::sensor::loads::read_loads;
use feeler::sensor::located_layout::LocatedLayout;
use feeler::sensor::moments::ElementMoments;
use feeler::sensor::reading::{SensorError, TactileFrame, TactileSensor};
use feeler_lab::config::Experiment;
use feeler_link::hand_inbox::HandInbox;
use feeler_link::inbox::Inbox;
use feeler_link::message::{Heartbeat, NO_FINGER, PROTOCOL};
use feeler_link::peers::{Expected, MOST_PEERS};
use feeler_link::rig_inbox::RigInbox;
use feeler_link::run_clock::{RigSpeed, RunClock};
use feeler_link::sense_inbox::SenseInbox;
use feeler_link::topic::{Place, Topic};
use feeler_record::wire::cdr;
use feeler_record::{RecordedCamera, RecordedHand, RecordedSensor, Recording};
use feeler_sources::picture::decode_picture;
use glam::DVec2;
use std::io::Cursor;
use std::str::from_utf8;

/// Most pixels of a layout whose sub-regions are laid out: larger ones only take time.
const MAX_PIXELS: usize = 1 << 16;

/// A sound layout reads back as it was written, and its kernel is made or refused.
pub fn layout(bytes: &[u8]) -> bool {
    let Some(layout) = text(bytes).and_then(|text| LocatedLayout::from_toml(text).ok()) else {
        return false;
    };
    let written = layout
        .to_toml()
        .expect("a layout that was read can be written");
    let again = LocatedLayout::from_toml(&written).expect("what was written can be read");
    assert_eq!(layout, again);
    if layout.width * layout.height <= MAX_PIXELS && layout.elements.len() <= 64 {
        let _ = layout.kernel();
    }
    true
}

/// A sound calibration reads back as it was written and gives finite forces for finite moments.
pub fn calibration(bytes: &[u8]) -> bool {
    let Some(calibration) = text(bytes).and_then(|text| Calibration::from_toml(text).ok()) else {
        return false;
    };
    let written = calibration
        .to_toml()
        .expect("a calibration that was read can be written");
    let again = Calibration::from_toml(&written).expect("what was written can be read");
    assert_eq!(calibration, again);
    for element in &calibration.elements {
        for factor in [0.0, 0.5, 1.0, 1.5, 10.0] {
            for offset in [-1e-3, 0.0, 1e-3] {
                let moments = ElementMoments {
                    integrated_gray: element.unloaded_gray * factor,
                    centroid: element.unloaded_centroid + DVec2::new(offset, -offset),
                };
                let force = element.force(&moments);
                assert!(force.is_finite(), "{moments:?}: {force}");
                let _ = element.validity(&moments);
            }
        }
    }
    true
}

/// Sound loads are finite, on as many elements as there are.
pub fn loads(bytes: &[u8]) -> bool {
    const ELEMENTS: usize = 3;
    let Ok(pictures) = read_loads(bytes, ELEMENTS) else {
        return false;
    };
    for picture in &pictures {
        assert_eq!(picture.forces.len(), ELEMENTS);
        assert!(
            picture
                .forces
                .iter()
                .flatten()
                .all(|force| force.is_finite())
        );
    }
    true
}

/// A sound picture has as many pixels as it says.
pub fn picture(bytes: &[u8]) -> bool {
    let Ok(picture) = decode_picture(bytes) else {
        return false;
    };
    assert_eq!(picture.pixels.len(), picture.width * picture.height);
    true
}

/// A sound experiment keeps its values when its text is read again.
pub fn experiment(bytes: &[u8]) -> bool {
    let read = |text: &str| Experiment::parse(text, "fuzz", &[], None).ok();
    let Some(experiment) = text(bytes).and_then(read) else {
        return false;
    };
    let again = read(&experiment.toml).expect("the text of an experiment can be read");
    assert_eq!(experiment.config, again.config);
    true
}

/// A recording is complete exactly when nothing is wrong with it, and plays back to its end.
pub fn recording(bytes: &[u8]) -> bool {
    let Ok(recording) = Recording::from_bytes(bytes) else {
        return false;
    };
    assert_eq!(recording.complete, recording.problem.is_none());
    assert_eq!(recording.fingers.len(), recording.facts.fingers);
    assert!(recording.readable_until.is_finite());
    play_back(&recording);
    look_again(&recording, bytes);
    true
}

/// Cameras give as many pictures as were seen, or say which is not there.
fn look_again(recording: &Recording, bytes: &[u8]) {
    for (finger, recorded) in recording.fingers.iter().enumerate() {
        let mut camera = RecordedCamera::new(Cursor::new(bytes), recording, finger);
        let mut frame = Frame::black(4, 3);
        let mut seen = 0;
        let end = loop {
            match camera.capture(&mut frame) {
                Ok(()) => seen += 1,
                Err(end) => break end,
            }
        };
        if let CameraError::Ended { count } = end {
            assert_eq!((count, seen), (seen, recorded.tactile.len() as u64));
        }
    }
}

/// Sensors and hand give as many readings as were recorded, or say what does not fit.
fn play_back(recording: &Recording) {
    for (finger, recorded) in recording.fingers.iter().enumerate() {
        let mut sensor = RecordedSensor::new(recording, finger);
        let mut reading = TactileFrame::unloaded(sensor.element_count());
        let mut read = 0;
        let end = loop {
            match sensor.read(&mut reading) {
                Ok(()) => read += 1,
                Err(end) => break end,
            }
        };
        match end {
            SensorError::Ended { count } => {
                assert_eq!((count, read), (read, recorded.tactile.len() as u64));
            }
            // Frames of different lengths.
            SensorError::ElementCount { expected, actual } => assert_ne!(expected, actual),
            other => panic!("a recording has neither camera nor picture: {other}"),
        }
    }
    let mut hand = RecordedHand::new(recording);
    let mut state = HandState::zero(hand.finger_count());
    let shortest = recording.fingers.iter().map(|f| f.joints.len()).min();
    for _ in 0..shortest.unwrap_or(0) {
        hand.read(&mut state).expect("a state of every finger");
    }
    let end = hand.read(&mut state);
    assert!(recording.fingers.is_empty() || end.is_err(), "{state:?}");
}

/// Whatever other programs say, a hand, a rig and a sensor program of two elements keep nothing that is not
/// finite or of another size. The bytes are messages: topic (its place in [`Topic::all`]), length (2 bytes, little
/// endian) and the message itself, in which an echoed token of 0 stands for the hand's own.
pub fn link(bytes: &[u8]) -> bool {
    let expected = Expected {
        fingertips: vec![String::new()],
        ..Expected::default()
    };
    let clock = RunClock::new(RigSpeed::Times(1.0), 0.01, 3.5);
    let mut hand = HandInbox::new(&[2], clock, expected.clone());
    let mut rig = RigInbox::new((1, 2), 0.045, expected.clone());
    let mut sense = SenseInbox::new((0, 2), (3, 2), expected);
    let (mut now, mut bytes, mut sound) = (0.0, bytes, false);
    let topics = Topic::all(0);
    for (place, introduction) in introductions() {
        for inbox in [&mut hand as &mut dyn Inbox, &mut rig, &mut sense] {
            let taken = inbox.take(Topic::Heartbeat(place), &introduction, now);
            taken.expect("a heartbeat of a program that agrees");
        }
    }
    while let [topic, low, high, rest @ ..] = bytes {
        let topic = topics[usize::from(*topic) % topics.len()];
        let length = usize::from(u16::from_le_bytes([*low, *high])).min(rest.len());
        let (message, rest) = rest.split_at(length);
        let mut message = message.to_vec();
        (now, bytes) = (now + 0.01, rest);
        let step = hand.sent.newest() + 1;
        hand.sent.sent(step, now);
        fill_in_token(&hand, &mut message);
        for inbox in [&mut hand as &mut dyn Inbox, &mut rig, &mut sense] {
            sound |= inbox.take(topic, &message, now).is_ok();
            assert!(inbox.peers().all().len() <= MOST_PEERS);
        }
        check_hand(&mut hand, now);
        rig.time = now;
        let drive = rig.drive(now, 0.045).unwrap_or_default();
        assert!(drive.iter().all(|velocity| velocity.is_finite()));
        let _ = sense.take_next().map(|exposed| exposed.header());
        let _ = sense.echo_at(now);
    }
    sound
}

/// Puts the hand's token of the echoed step where a message's header has a token of 0.
fn fill_in_token(hand: &HandInbox, message: &mut [u8]) {
    // Behind four bytes of encapsulation: protocol, instance, clock, sequence and stamp of eight bytes each.
    let Some((head, [token @ .., _, _, _, _, _, _, _, _])) = message
        .get_mut(4 + 40..4 + 64)
        .and_then(|m| m.split_first_chunk_mut::<8>())
    else {
        return;
    };
    if token.iter().all(|byte| *byte == 0) {
        let step = u64::from_le_bytes(*head);
        token.copy_from_slice(&hand.sent.token(step).to_le_bytes());
    }
}

/// The first heartbeats of a hand, a world and a sensor program, whose instances are 1, 2 and 3.
fn introductions() -> [(Place, Vec<u8>); 3] {
    let programs = [
        (Place::Hand, "hand", NO_FINGER),
        (Place::World, "world", NO_FINGER),
        (Place::Sense(0), "sense", 0),
    ];
    let mut instance = 0;
    programs.map(|(place, program, finger)| {
        instance += 1;
        let heartbeat = Heartbeat {
            protocol: PROTOCOL,
            instance,
            program: program.into(),
            finger,
            sequence: 1,
            ..Heartbeat::default()
        };
        let mut bytes = Vec::new();
        cdr::encode(&heartbeat, &mut bytes).expect("a heartbeat's bytes");
        (place, bytes)
    })
}

/// What the hand keeps is whole and finite, and no data are from a time to come.
fn check_hand(hand: &mut HandInbox, now: f64) {
    let _ = hand.stale(now, 0.035);
    assert!((0.0..1e9).contains(&hand.state().time), "{now} s");
    assert!(hand.time_of(0) >= 0.0);
    assert!(hand.holds.in_force().len() <= 16);
    let (state, mut fingers) = hand.ages(now);
    assert!(state >= 0.0 && fingers.all(|age| age >= 0.0), "{now} s");
    for update in hand.fingers().iter().filter_map(|f| f.newest.as_ref()) {
        assert_eq!((update.forces.len(), update.shear_rate.len()), (2, 2));
        let forces = update.forces.iter().flat_map(|f| [f.x, f.y, f.z]);
        assert!(forces.chain([update.grasp_force]).all(f64::is_finite));
    }
    if let Some(state) = &hand.state().newest {
        let joints = state.position.iter().chain(&state.velocity);
        let joints: Vec<_> = joints.flat_map(|j| [j.x, j.y, j.z]).collect();
        assert_eq!(joints.len(), 6);
        assert!(joints.into_iter().all(f64::is_finite));
    }
}

fn text(bytes: &[u8]) -> Option<&str> {
    from_utf8(bytes).ok()
}
