//! Acceptance of programs by their heartbeats.

use super::bench::{NOBODY, SENSE, WORLD, expected, hand, hear, heartbeat, put};
use feeler_link::inboxes::{Inbox, Peers};
use feeler_link::messages::message::Heartbeat;
use feeler_link::messages::{Mismatch, Rejection};
use feeler_link::transport::{ProgramRole, Topic, encode};

/// Reason for refusing a program with this heartbeat, if any.
fn refused(heartbeat: &Heartbeat) -> Option<Mismatch> {
    let mut peers = Peers::new(expected());
    let place = heartbeat.place().unwrap();
    let heard = peers.heard(place, &encode(heartbeat).unwrap(), 0.0);
    heard.unwrap().unwrap().refused.clone()
}

#[test]
fn mismatching_programs_are_refused_by_name() {
    for program in ["hand", "world", "sense", "order"] {
        assert_eq!(refused(&heartbeat(program, NOBODY)), None, "{program}");
    }
    let other_experiment = Heartbeat {
        experiment: "theirs".into(),
        ..heartbeat("world", NOBODY)
    };
    let other_fingertip = Heartbeat {
        fingertip: "theirs".into(),
        ..heartbeat("sense", NOBODY)
    };
    let no_such_finger = Heartbeat {
        finger: 1,
        ..heartbeat("sense", NOBODY)
    };
    let other_speed = Heartbeat {
        speed: 0.0,
        ..heartbeat("world", NOBODY)
    };
    for (heartbeat, words) in [
        (
            other_experiment,
            "world runs experiment theirs, this program ours",
        ),
        (other_fingertip, "sense of finger 0 uses fingertip theirs"),
        (no_such_finger, "sense of finger 1 uses fingertip tip"),
        (
            other_speed,
            "world runs at the pace of the hand's answers (max), this hand at 1 times",
        ),
    ] {
        let said = refused(&heartbeat).map(|mismatch| mismatch.to_string());
        let said = said.unwrap_or_default();
        assert!(said.starts_with(words), "{said}");
    }
}

#[test]
fn each_invalid_heartbeat_field_is_rejected() {
    type Spoil = fn(&mut Heartbeat);
    let cases: [(Spoil, Rejection); 10] = [
        (|h| h.sequence = 1, Rejection::Old),
        (|h| h.sequence = u64::MAX, Rejection::Implausible),
        (|h| h.rate = f64::NAN, Rejection::NotFinite),
        (|h| h.speed = f64::INFINITY, Rejection::NotFinite),
        (|h| h.speed = -1.0, Rejection::Implausible),
        (|h| h.fault = "x".repeat(257), Rejection::Oversized),
        (|h| h.version = "x".repeat(257), Rejection::Oversized),
        (|h| h.experiment = "theirs".into(), Rejection::Stranger),
        (|h| h.finger = 0, Rejection::Stranger),
        (|h| h.program = "another".into(), Rejection::Stranger),
    ];
    for (index, (spoil, rejection)) in cases.into_iter().enumerate() {
        let mut beat = heartbeat("world", WORLD);
        beat.sequence = 2;
        spoil(&mut beat);
        let taken = put(
            &mut hand(),
            Topic::Heartbeat(ProgramRole::World),
            &beat,
            0.1,
        );
        assert_eq!(taken, Err(rejection), "{index}");
    }
    // On the topic of another place, too.
    let beat = heartbeat("world", NOBODY);
    let taken = put(&mut hand(), Topic::Heartbeat(ProgramRole::Hand), &beat, 0.1);
    assert_eq!(taken, Err(Rejection::Stranger));
}

#[test]
fn texts_of_heartbeats_are_escaped() {
    let mut hand = hand();
    let beat = Heartbeat {
        sequence: 2,
        fault: "\u{1b}]0;gone\u{7}\nall is well".into(),
        ..heartbeat("sense", SENSE)
    };
    hear(&mut hand, &beat, 0.1).unwrap();
    let mut peers = hand.peers().all().iter();
    let said = peers.find(|peer| peer.heartbeat.instance == SENSE).unwrap();
    assert_eq!(said.heartbeat.fault, "\\u{1b}]0;gone\\u{7}\\nall is well");
}

#[test]
fn a_place_is_free_after_a_second_of_silence() {
    let mut hand = hand();
    hear(&mut hand, &heartbeat("world", 20), 0.9).unwrap();
    let refusal = |hand: &feeler_link::inboxes::HandInbox| {
        let mut peers = hand.peers().all().iter();
        peers
            .find(|peer| peer.heartbeat.instance == 20)
            .and_then(|peer| peer.refused.clone())
    };
    assert!(matches!(refusal(&hand), Some(Mismatch::Taken { .. })));
    let again = Heartbeat {
        sequence: 2,
        ..heartbeat("world", 20)
    };
    hear(&mut hand, &again, 1.05).unwrap();
    assert_eq!(refusal(&hand), None);
    // If the first program returns, it counts as a second one.
    let first = Heartbeat {
        sequence: 3,
        ..heartbeat("world", WORLD)
    };
    hear(&mut hand, &first, 1.1).unwrap();
    let mut peers = hand.peers().all().iter();
    let first = peers.find(|peer| peer.heartbeat.instance == WORLD).unwrap();
    assert!(matches!(first.refused, Some(Mismatch::Taken { .. })));
}
