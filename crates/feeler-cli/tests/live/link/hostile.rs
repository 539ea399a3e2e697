//! A hostile peer on the same network: its messages are dropped and counted, and cause no motion.

use super::faults::{NO_HURRY, check};
use crate::rig::{QUARTER, Setup, connect, within_reason};
use feeler_link::messages::message::{
    CommandMessage, HandMode, Heartbeat, MessageHeader, NO_FINGER, PROTOCOL, ProgramKind,
    ResumeMessage, StateMessage, StopMessage, TactileUpdate,
};
use feeler_link::transport::{Link, MessageHandler, Network, Outlet, Topic, draw_instance, send};
use feeler_record::wire::{Vector3, cdr};
use std::collections::HashMap;
use std::io::Write;
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use std::{fs, thread};

const NOT_A_NUMBER: Vector3 = Vector3 {
    x: f64::NAN,
    y: 0.0,
    z: 0.0,
};

#[test]
fn hostile_messages_are_counted_and_cause_no_motion() {
    let mut rig = Setup::new("link-hostile").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    // A stopped hand must stay stopped.
    rig.setup.order("stop", &[]).done();
    hand.wait_for("stopped: stop requested by the test");
    let peer = connect(&rig.setup.endpoint);
    let instances = spy(&peer);
    let stops = Arc::new(Mutex::new(Vec::new()));
    listen_for_stops(&peer, &stops);
    // One after the other, because long garbage fills the link, which then drops nearly all other messages.
    for _ in 0..20 {
        say_garbage(&peer);
        thread::sleep(Duration::from_millis(10));
    }
    for _ in 0..50 {
        say_in_the_name_of_others(&peer, &instances);
        thread::sleep(Duration::from_millis(10));
    }
    assert!(!hand.said().contains("resuming"), "{}", hand.said());
    // Any message that decodes as a stop is obeyed, even without a sender name, as here.
    within_reason(&hand, || stops.lock().expect("the notes").len() > 1);
    let told = rig.setup.order("resume", &[]);
    assert!(told.stdout.contains("unknown"), "{told:?}");
    rig.resume_from(&hand, "unknown");
    hand.wait_for("resuming");
    let said = check(&mut rig, hand, "stop requested by the test");
    for said in [said.hand, said.world] {
        for reason in ["malformed", "of another size", "not finite", "too long"] {
            assert!(said.contains(reason), "no {reason:?} in {said}");
        }
    }
}

/// A recorded session that is replayed to another hand causes no motion.
#[test]
fn replayed_session_does_not_move_another_hand() {
    let setup = Setup::new("link-replayed").with(&[NO_HURRY]);
    let mut rig = setup.at(QUARTER).start();
    let mut hand = rig.moving_hand(&[]);
    let peer = connect(&rig.setup.endpoint);
    let session = Arc::new(Mutex::new(Vec::new()));
    let tape = session.clone();
    let note: MessageHandler = Arc::new(move |topic: Topic, bytes: &[u8]| {
        tape.lock().expect("the tape").push((topic, bytes.to_vec()));
    });
    let topics = [Topic::State, Topic::Tactile(0), Topic::Tactile(1)];
    for topic in topics.into_iter().chain(Topic::heartbeats()) {
        peer.listen(topic, note.clone()).expect("a subscription");
    }
    thread::sleep(Duration::from_secs(2));
    let session = std::mem::take(&mut *session.lock().expect("the tape"));
    assert!(session.len() > 100, "{}", session.len());
    for program in [&mut hand, &mut rig.world]
        .into_iter()
        .chain(&mut rig.senses)
    {
        program.signal("KILL");
        program.wait();
    }
    let first = rig.setup.folder.join("run");
    fs::rename(&first, first.with_extension("first")).expect("the run");
    let mut hand = rig.setup.hand(&[]);
    hand.wait_for("waiting for");
    for (topic, bytes) in session {
        peer.send(topic, bytes).expect("a link");
        thread::sleep(Duration::from_millis(10));
    }
    hand.signal("INT");
    let (status, said) = hand.wait();
    assert_eq!(status, Some(1), "{said}");
    assert!(!first.exists(), "the run started: {said}");
}

/// Instances of the running programs, by program name.
fn spy(peer: &Link) -> HashMap<String, u64> {
    let heard = Arc::new(Mutex::new(HashMap::new()));
    let notes = heard.clone();
    let note = move |_: Topic, bytes: &[u8]| {
        let Ok(heartbeat) = cdr::decode::<Heartbeat>(bytes) else {
            return;
        };
        let mut notes = notes.lock().expect("the notes");
        notes.insert(heartbeat.program.to_string(), heartbeat.instance);
    };
    let note: MessageHandler = Arc::new(note);
    for topic in Topic::heartbeats() {
        let listening = peer.listen(topic, note.clone());
        listening.expect("the others' heartbeats");
    }
    loop {
        let known = heard.lock().expect("the notes").clone();
        if ["hand", "world", "sense"]
            .iter()
            .all(|p| known.contains_key(*p))
        {
            return known;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Sends on all topics: an empty message, noise, a truncated message, an excessive length field, a message that is too
/// long.
fn say_garbage(peer: &Link) {
    let mut whole = Vec::new();
    cdr::encode(&StateMessage::default(), &mut whole).expect("its bytes");
    let noise: Vec<u8> = (0..200u32).map(|k| (k * k * 31 + 7) as u8).collect();
    // Its first length field has the maximum value.
    let boast = [&cdr::ENCAPSULATION[..], &[0xff; 60]].concat();
    let long = vec![0; Topic::Tactile(0).most_bytes() + 1];
    for topic in Topic::all(0) {
        // Orders are accepted from every participant: without certificates, from any program on this computer.
        let pieces = [&[][..], &noise, &whole[..whole.len() - 9], &boast, &long];
        for piece in pieces {
            peer.send(topic, piece.to_vec()).expect("a link");
        }
    }
}

/// Sends messages with NaN or with too many elements in the name of known programs.
fn say_in_the_name_of_others(peer: &Link, instances: &HashMap<String, u64>) {
    let header = |program: &str| MessageHeader {
        protocol: PROTOCOL,
        instance: instances[program],
        sequence: u64::MAX,
        echo_step: 1,
        ..MessageHeader::default()
    };
    let update = |elements: usize, force| TactileUpdate {
        header: header("sense"),
        forces: vec![force; elements],
        shear_rate: vec![0.0; elements],
        slip_mask: vec![0; elements.div_ceil(8)],
        invalid_mask: vec![0; elements.div_ceil(8)],
        ..TactileUpdate::default()
    };
    for update in [update(41, NOT_A_NUMBER), update(400, Vector3::default())] {
        send(peer, Topic::Tactile(0), &update).expect("a link");
    }
    let command = |fingers| CommandMessage {
        header: header("hand"),
        token: 1,
        state_sequence: u64::MAX,
        joint_velocity: vec![NOT_A_NUMBER; fingers],
    };
    for command in [command(2), command(1000)] {
        send(peer, Topic::Command, &command).expect("a link");
    }
    let state = StateMessage {
        header: header("world"),
        position: vec![NOT_A_NUMBER; 2],
        velocity: vec![Vector3::default(); 2],
        ..StateMessage::default()
    };
    send(peer, Topic::State, &state).expect("a link");
}

/// Sends garbage, impersonates known and unknown programs, stops and resumes the hand, and opens connections that send
/// nonsense, until `over`. Reconnects every few seconds.
pub fn be_hostile(endpoint: &str, over: &AtomicBool) {
    let address = endpoint.split_once('/').expect("an endpoint").1;
    while !over.load(Ordering::Relaxed) {
        let peer = connect(endpoint);
        let instances = spy(&peer);
        let stops = Arc::new(Mutex::new(Vec::new()));
        listen_for_stops(&peer, &stops);
        for turn in 0..500 {
            if over.load(Ordering::Relaxed) {
                return;
            }
            say_garbage(&peer);
            say_in_the_name_of_others(&peer, &instances);
            introduce_somebody(&peer);
            if turn % 100 == 50 {
                stop(&peer);
            }
            resume(&peer, &stops);
            if turn % 10 == 0
                && let Ok(mut stream) = TcpStream::connect(address)
            {
                let _ = stream.write_all(b"not a handshake\r\n\r\n");
            }
            thread::sleep(Duration::from_millis(10));
        }
    }
}

/// Stores the numbers of the active stops in `stops`.
fn listen_for_stops(peer: &Link, stops: &Arc<Mutex<Vec<u64>>>) {
    let notes = stops.clone();
    let note = move |_: Topic, bytes: &[u8]| {
        if let Ok(mode) = cdr::decode::<HandMode>(bytes) {
            let numbers = mode.stops.iter().map(|stop| stop.number);
            *notes.lock().expect("the notes") = numbers.collect();
        }
    };
    let listening = peer.listen(Topic::Mode, Arc::new(note));
    listening.expect("the hand's modes");
}

fn stop(peer: &Link) {
    let stop = StopMessage {
        protocol: PROTOCOL,
        from: "\u{1b}[2J".repeat(1000),
        id: draw_instance(),
    };
    send(peer, Topic::Stop, &stop).expect("a link");
}

fn resume(peer: &Link, stops: &Mutex<Vec<u64>>) {
    let stops = stops.lock().expect("the notes").clone();
    for number in stops.into_iter().chain([draw_instance()]) {
        let resume = ResumeMessage {
            protocol: PROTOCOL,
            from: "a stranger".into(),
            number,
        };
        send(peer, Topic::Resume, &resume).expect("a link");
    }
}

/// Announces a sensor program, a rig and a hand that do not exist.
fn introduce_somebody(peer: &Link) {
    let programs = [
        (ProgramKind::Sense, 0),
        (ProgramKind::World, NO_FINGER),
        (ProgramKind::Hand, NO_FINGER),
    ];
    for (program, finger) in programs {
        let heartbeat = Heartbeat {
            protocol: PROTOCOL,
            instance: draw_instance(),
            program,
            finger,
            version: "x".repeat(200),
            fault: "y".repeat(200),
            ..Heartbeat::default()
        };
        let place = heartbeat.place().expect("a place");
        send(peer, Topic::Heartbeat(place), &heartbeat).expect("a link");
    }
}
