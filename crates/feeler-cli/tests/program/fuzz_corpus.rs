//! Feeds the corpora of the fuzz targets to the functions of the targets, without cargo-fuzz.

#[path = "../../../../fuzz/src/bodies.rs"]
mod bodies;

use crate::how_many::how_many;
use feeler_link::messages::message::{
    CommandMessage, DirectForces, HandMode, Heartbeat, MessageHeader, NO_FINGER, PROTOCOL,
    PictureMessage, ProgramKind, ResumeMessage, StateMessage, StopMessage, TactileUpdate,
};
use feeler_link::transport::{ProgramRole, Topic};
use feeler_record::wire::{Message, Vector3, cdr};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::path::Path;

/// Contents of the files in a target's corpus.
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .join("fuzz/corpus")
        .join(target);
    let files = std::fs::read_dir(&folder).expect("the target's corpus");
    let mut paths: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
    // The order of directory entries is unspecified.
    paths.sort();
    let bytes = paths.iter().map(std::fs::read);
    bytes.collect::<Result<_, _>>().expect("their bytes")
}

/// Feeds every file of a target's corpus to it. At least one must be valid.
fn feed(target: &str, body: fn(&[u8]) -> bool) {
    let sound = corpus(target).iter().filter(|bytes| body(bytes)).count();
    assert!(sound > 0, "the corpus of {target} has no valid file");
}

/// Feeds hostile bytes to a target (ten million with `FEELER_FUZZ=10000000`): noise, and corpus files that are
/// truncated and have changed bytes.
fn survive(target: &str, body: fn(&[u8]) -> bool) {
    let (corpus, mut random) = (corpus(target), Pcg64::seed_from_u64(1));
    let mut left = how_many("FEELER_FUZZ", 20_000);
    while left > 0 {
        let mut bytes: Vec<u8> = if random.random() {
            let length = random.random_range(1..64_usize);
            (0..length).map(|_| random.random()).collect()
        } else {
            corpus[random.random_range(0..corpus.len())].clone()
        };
        bytes.truncate(random.random_range(0..=2 * bytes.len()));
        if !bytes.is_empty() {
            for _ in 0..random.random_range(0..8) {
                let at = random.random_range(0..bytes.len());
                bytes[at] = random.random();
            }
        }
        body(&bytes);
        left = left.saturating_sub(1 + bytes.len());
    }
}

#[test]
fn hostile_packets_of_devices_cause_no_panic() {
    survive("drives_bus", bodies::drives_bus);
    survive("netft", bodies::netft);
    survive("skins", bodies::skins);
    survive("ros2", bodies::ros2);
}

/// Feeds damaged corpus files to a target (a million with `FEELER_MUTATIONS=1000000`): with changed, removed or
/// repeated bytes, truncated, or with the end of another file appended.
fn mutate(target: &str, body: fn(&[u8]) -> bool) {
    let (corpus, mut random) = (corpus(target), Pcg64::seed_from_u64(2));
    for _ in 0..how_many("FEELER_MUTATIONS", 300) {
        let mut bytes = corpus[random.random_range(0..corpus.len())].clone();
        for _ in 0..random.random_range(1..6) {
            let at = random.random_range(0..=bytes.len());
            let end = (at + random.random_range(0..16)).min(bytes.len());
            match random.random_range(0..6) {
                0 => bytes.truncate(at),
                1 => drop(bytes.drain(at..end)),
                2 => bytes.extend_from_within(at..end),
                3 => {
                    let other = &corpus[random.random_range(0..corpus.len())];
                    bytes.truncate(at);
                    bytes.extend(&other[at.min(other.len())..]);
                }
                _ => random.fill(&mut bytes[at..end]),
            }
        }
        body(&bytes);
    }
}

#[test]
fn damaged_files_cause_no_panic() {
    mutate("picture", bodies::picture);
    mutate("recording", bodies::recording);
    mutate("loads", bodies::loads);
    mutate("forces", bodies::forces);
    mutate("taxels", bodies::taxels);
}

#[test]
fn messages_of_ros_2() {
    feed("ros2", bodies::ros2);
}

#[test]
fn layouts() {
    feed("layout", bodies::layout);
}

#[test]
fn servo_buses() {
    feed("drives_bus", bodies::drives_bus);
}

#[test]
fn skins() {
    feed("skins", bodies::skins);
}

#[test]
fn taxels() {
    feed("taxels", bodies::taxels);
}

#[test]
fn calibrations() {
    feed("calibration", bodies::calibration);
}

#[test]
fn wrench_calibrations() {
    feed("wrench", bodies::wrench);
}

#[test]
fn forces() {
    feed("forces", bodies::forces);
}

#[test]
fn force_sensors() {
    feed("netft", bodies::netft);
}

#[test]
fn policies() {
    feed("policy", bodies::policy);
}

#[test]
fn loads() {
    feed("loads", bodies::loads);
}

#[test]
fn pictures() {
    feed("picture", bodies::picture);
}

#[test]
fn experiments() {
    feed("experiment", bodies::experiment);
}

#[test]
fn recordings() {
    feed("recording", bodies::recording);
}

#[test]
fn links() {
    feed("link", bodies::link);
}

#[test]
fn inboxes() {
    feed("inboxes", bodies::inboxes);
}

#[test]
fn stop_calls() {
    feed("stop_wire", bodies::stop_wire);
}

/// Runs the targets on random input without a fuzzer. `FEELER_FUZZ` is the number of inputs, `FEELER_FUZZ_SEED` the
/// seed.
#[test]
fn inboxes_keep_their_invariants_on_random_input() {
    let inputs = how_many("FEELER_FUZZ", 2000);
    let mut random = Pcg64::seed_from_u64(how_many("FEELER_FUZZ_SEED", 14) as u64);
    let mut sound = 0_u64;
    for _ in 0..inputs {
        let mut bytes = vec![0; random.random_range(0..64) * 8];
        random.fill(&mut bytes[..]);
        sound += u64::from(bodies::inboxes(&bytes));
        bodies::link(&bytes);
        bodies::stop_wire(&bytes);
    }
    assert!(sound > 0);
}

#[test]
fn each_kind_of_message_is_accepted() {
    for (place, message) in messages().iter().enumerate() {
        assert!(bodies::link(message), "{place}: {message:?}");
    }
}

/// Rewrites the link's corpus after its messages have changed:
/// `cargo test --test program fuzz_corpus:: -- --ignored write`.
#[test]
#[ignore = "writes into the source tree"]
fn write_the_corpus_of_the_link() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("fuzz/corpus/link");
    std::fs::create_dir_all(&folder).expect("the corpus");
    let whole = messages();
    let all: Vec<u8> = whole.iter().flatten().copied().collect();
    let cut = all[..all.len() - 5].to_vec();
    for (name, bytes) in [("one-of-each", all), ("cut-off", cut)] {
        std::fs::write(folder.join(name), bytes).expect("a file of the corpus");
    }
}

/// One message of each kind in the format of the link's fuzz target, sent by the programs that it introduces.
fn messages() -> Vec<Vec<u8>> {
    let header = |instance, sequence| MessageHeader {
        protocol: PROTOCOL,
        instance,
        clock: 2,
        sequence,
        echo_step: 1,
        ..MessageHeader::default()
    };
    let update = TactileUpdate {
        // Stamped by a separate camera clock.
        header: MessageHeader {
            clock: 3,
            ..header(3, 1)
        },
        forces: vec![Vector3::default(); 2],
        shear_rate: vec![0.0; 2],
        slip_mask: vec![0],
        invalid_mask: vec![0],
        ..TactileUpdate::default()
    };
    let picture = PictureMessage {
        header: header(2, 1),
        width: 3,
        height: 2,
        pixels: vec![0; 6],
        ..PictureMessage::default()
    };
    let forces = DirectForces {
        header: header(2, 2),
        forces: vec![Vector3::default(); 2],
        ..DirectForces::default()
    };
    let command = CommandMessage {
        header: header(1, 2),
        token: 1,
        state_sequence: 1,
        joint_velocity: vec![Vector3::default()],
    };
    let state = StateMessage {
        header: header(2, 3),
        position: vec![Vector3::default()],
        velocity: vec![Vector3::default()],
        ..StateMessage::default()
    };
    let mode = HandMode {
        header: header(1, 1),
        token: 1,
        ..HandMode::default()
    };
    let heartbeat = Heartbeat {
        protocol: PROTOCOL,
        instance: 4,
        program: ProgramKind::Order,
        finger: NO_FINGER,
        sequence: 1,
        ..Heartbeat::default()
    };
    let (protocol, from) = (PROTOCOL, "fuzz".to_string());
    let stop = StopMessage {
        protocol,
        from: from.clone(),
        id: 5,
    };
    let resume = ResumeMessage {
        protocol,
        from,
        number: 1,
    };
    vec![
        framed(Topic::Mode, &mode),
        framed(Topic::Tactile(0), &update),
        framed(Topic::Picture(0), &picture),
        framed(Topic::DirectForces(0), &forces),
        framed(Topic::State, &state),
        framed(Topic::Command, &command),
        framed(Topic::Heartbeat(ProgramRole::Order), &heartbeat),
        framed(Topic::Stop, &stop),
        framed(Topic::Resume, &resume),
    ]
}

fn framed<M: Message>(topic: Topic, message: &M) -> Vec<u8> {
    let place = Topic::all(0).iter().position(|&t| t == topic);
    let mut bytes = Vec::new();
    cdr::encode(message, &mut bytes).expect("its bytes");
    let length = u16::try_from(bytes.len()).expect("a short message");
    let mut framed = vec![place.expect("a topic of the link") as u8];
    framed.extend(length.to_le_bytes());
    framed.extend(bytes);
    framed
}
