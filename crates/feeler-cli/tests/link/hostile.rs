//! A hostile peer on the same network: whatever it says is dropped and counted, and nothing moves by it.

use super::faults::{NO_HURRY, check};
use super::rig::Setup;
use feeler_link::endpoints::LinkConfig;
use feeler_link::message::{
    CommandMessage, Heartbeat, MessageHeader, PROTOCOL, StateMessage, TactileUpdate,
};
use feeler_link::network::{Heard, Network};
use feeler_link::outlet::{Outlet, send};
use feeler_link::topic::Topic;
use feeler_link::transport::Link;
use feeler_record::wire::{Vector3, cdr};
use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;

const NOT_A_NUMBER: Vector3 = Vector3 {
    x: f64::NAN,
    y: 0.0,
    z: 0.0,
};

#[test]
fn a_hostile_peer_is_counted_and_moves_nothing() {
    let mut rig = Setup::new("link-hostile").with(&[NO_HURRY]).start();
    let mut hand = rig.moving_hand(&[]);
    // A hand that is told to stop stays so, whatever comes.
    rig.setup.order("stop", &[]).done();
    hand.wait_for("stopped: told to stop by the test");
    let peer = Link::open(&LinkConfig {
        rig: "cap-closing".into(),
        connect: vec![rig.setup.endpoint.clone()],
        ..LinkConfig::default()
    });
    let peer = peer.expect("a place in the link");
    let instances = spy(&peer);
    for _ in 0..20 {
        say_garbage(&peer);
        say_in_the_name_of_others(&peer, &instances);
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(!hand.said().contains("going on"), "{}", hand.said());
    rig.resume(&hand);
    hand.wait_for("going on");
    let said = check(&mut rig, hand, "told to stop by the test");
    for said in [said.hand, said.world] {
        for reason in ["malformed", "of another size", "not finite", "too long"] {
            assert!(said.contains(reason), "no {reason:?} in {said}");
        }
    }
}

/// The instances of all programs that work, by what they are.
fn spy(peer: &Link) -> HashMap<String, u64> {
    let heard = Arc::new(Mutex::new(HashMap::new()));
    let notes = heard.clone();
    let note = move |_: Topic, bytes: &[u8]| {
        let heartbeat: Heartbeat = cdr::decode(bytes).expect("a heartbeat");
        let mut notes = notes.lock().expect("the notes");
        notes.insert(heartbeat.program.to_string(), heartbeat.instance);
    };
    let note: Heard = Arc::new(note);
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

/// Nothing, noise, a message that is cut off, and one that is too long, on all topics.
fn say_garbage(peer: &Link) {
    let mut whole = Vec::new();
    cdr::encode(&StateMessage::default(), &mut whole).expect("its bytes");
    let noise: Vec<u8> = (0..200u32).map(|k| (k * k * 31 + 7) as u8).collect();
    // Its first field says that it is as long as can be.
    let boast = [&cdr::ENCAPSULATION[..], &[0xff; 60]].concat();
    let long = vec![0; Topic::Tactile(0).most_bytes() + 1];
    for topic in Topic::all(0) {
        // An order is an order from whoever is in the link: without certificates, everybody on the computer.
        let pieces = [&[][..], &noise, &whole[..whole.len() - 9], &boast, &long];
        for piece in pieces {
            peer.send(topic, piece.to_vec()).expect("a link");
        }
    }
}

/// Messages that hold no numbers or too many, by programs that are known.
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
        instruments: Vec::new(),
    };
    send(peer, Topic::State, &state).expect("a link");
}
