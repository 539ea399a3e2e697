//! States, forces and orders that the hand accepts or rejects.

use super::bench::{
    ELEMENTS, NOBODY, SENSE, STALE, WORLD, echoing, hand, hear, heartbeat, put, state, update,
};
use feeler::control::{StopReason, TactileReading, TactileSource};
use feeler_link::hand::{Permission, RemoteFinger};
use feeler_link::inboxes::{HandInbox, Inbox};
use feeler_link::messages::Rejection;
use feeler_link::messages::message::{
    InstrumentsMessage, MessageHeader, PROTOCOL, ResumeMessage, StateMessage, StopMessage,
    TactileUpdate,
};
use feeler_link::transport::{Shared, Topic, encode};
use feeler_record::wire::Vector3;
use glam::DQuat;

/// Arrival time of messages (s, on the hand's clock).
const NOW: f64 = 1.002;

fn sound_state(hand: &HandInbox, sequence: u64) -> StateMessage {
    state(echoing(&hand.sent, WORLD, sequence, 5.0))
}

fn sound_update(hand: &HandInbox, sequence: u64) -> TactileUpdate {
    update(echoing(&hand.sent, SENSE, sequence, 5.0))
}

/// Inbox of a hand that has accepted a state.
fn hand_with_state() -> HandInbox {
    let mut hand = hand();
    let first = sound_state(&hand, 1);
    put(&mut hand, Topic::State, &first, NOW).unwrap();
    hand
}

/// Result for a state after the change `spoil`.
fn spoiled_state(spoil: impl Fn(&mut StateMessage)) -> Result<(), Rejection> {
    let mut hand = hand_with_state();
    let mut message = sound_state(&hand, 2);
    spoil(&mut message);
    put(&mut hand, Topic::State, &message, NOW)
}

/// Result for an update after the change `spoil`.
fn spoiled_update(spoil: impl Fn(&mut TactileUpdate)) -> Result<(), Rejection> {
    let mut hand = hand_with_state();
    let mut message = sound_update(&hand, 2);
    spoil(&mut message);
    put(&mut hand, Topic::Tactile(0), &message, NOW)
}

/// Sets the effort of the first joint and its uncertainty.
fn set_efforts(state: &mut StateMessage, effort: f64, uncertainty: f64) {
    (state.effort, state.effort_uncertainty) = (vec![x(effort)], vec![x(uncertainty)]);
}

fn x(x: f64) -> Vector3 {
    Vector3 { x, y: 0.0, z: 0.0 }
}

/// Change that makes a header invalid, and the reason for its rejection.
type Spoiled = (fn(&mut MessageHeader), Rejection);

const HEADERS: [Spoiled; 9] = [
    (|h| h.protocol = 2, Rejection::Protocol),
    (|h| h.instance = NOBODY, Rejection::Unintroduced),
    (|h| h.echo_step = 0, Rejection::Unintroduced),
    (|h| h.echo_step = 101, Rejection::Future),
    (|h| h.echo_token += 1, Rejection::Unproven),
    (|h| h.echo_step = 99, Rejection::Unproven),
    (|h| h.echo_age = -1e-9, Rejection::Unproven),
    (|h| h.echo_age = f64::NAN, Rejection::Unproven),
    (|h| h.sequence = u64::MAX, Rejection::Implausible),
];

#[test]
fn each_invalid_header_field_is_rejected() {
    assert_eq!(spoiled_state(|_| {}), Ok(()));
    assert_eq!(spoiled_state(|s| set_efforts(s, f64::NAN, 0.1)), Ok(()));
    assert_eq!(spoiled_update(|_| {}), Ok(()));
    for (index, (spoil, rejection)) in HEADERS.into_iter().enumerate() {
        let refused = spoiled_state(|state| spoil(&mut state.header));
        // The first update of a program may have any sequence number.
        assert_eq!(refused, Err(rejection), "{index}");
        if rejection != Rejection::Implausible {
            let refused = spoiled_update(|update| spoil(&mut update.header));
            assert_eq!(refused, Err(rejection), "{index}");
        }
    }
}

#[test]
fn each_invalid_state_field_is_rejected() {
    type Spoil = fn(&mut StateMessage);
    let cases: [(Spoil, Rejection); 19] = [
        (|s| s.header.instance = SENSE, Rejection::Stranger),
        (|s| s.header.sequence = 1, Rejection::Old),
        (|s| s.header.stamp = 4.99, Rejection::Implausible),
        (|s| s.header.stamp = 1e6, Rejection::Implausible),
        (|s| s.header.stamp = 1e300, Rejection::Implausible),
        (|s| s.header.stamp = f64::NAN, Rejection::Implausible),
        (|s| s.position.push(x(0.0)), Rejection::Size),
        (|s| s.velocity.clear(), Rejection::Size),
        (|s| s.position[0] = x(1e308), Rejection::Implausible),
        (|s| s.effort = vec![x(0.0)], Rejection::Size),
        (|s| s.effort_uncertainty = vec![x(0.0)], Rejection::Size),
        (|s| set_efforts(s, 1e7, 0.0), Rejection::Implausible),
        (|s| set_efforts(s, f64::INFINITY, 0.0), Rejection::NotFinite),
        (|s| set_efforts(s, 0.0, f64::NAN), Rejection::NotFinite),
        (|s| s.position[0] = x(f64::NAN), Rejection::NotFinite),
        (|s| s.velocity[0] = x(1001.0), Rejection::Implausible),
        (
            |s| s.instruments = vec![InstrumentsMessage::default(); 2],
            Rejection::Size,
        ),
        (
            |s| {
                s.instruments = vec![InstrumentsMessage {
                    torque: f64::INFINITY,
                    ..InstrumentsMessage::default()
                }]
            },
            Rejection::NotFinite,
        ),
        (
            |s| {
                // Zeroed memory is not a valid rotation.
                let object_orientation = DQuat::from_array([0.0; 4]).into();
                s.instruments = vec![InstrumentsMessage {
                    object_orientation,
                    ..InstrumentsMessage::default()
                }]
            },
            Rejection::Implausible,
        ),
    ];
    for (index, (spoil, rejection)) in cases.into_iter().enumerate() {
        assert_eq!(spoiled_state(spoil), Err(rejection), "{index}");
    }
}

#[test]
fn each_invalid_update_field_is_rejected() {
    type Spoil = fn(&mut TactileUpdate);
    let cases: [(Spoil, Rejection); 11] = [
        (|u| u.header.instance = WORLD, Rejection::Stranger),
        // An update of another finger on this finger's topic.
        (|u| u.finger = 1, Rejection::Size),
        (|u| u.forces.truncate(ELEMENTS - 1), Rejection::Size),
        (|u| u.shear_rate.push(0.0), Rejection::Size),
        (|u| u.slip_mask.clear(), Rejection::Size),
        (|u| u.invalid_mask.push(0), Rejection::Size),
        (|u| u.forces[2] = x(1e308), Rejection::Implausible),
        (|u| u.forces[2] = x(f64::INFINITY), Rejection::NotFinite),
        (|u| u.shear_rate[0] = f64::NAN, Rejection::NotFinite),
        (|u| u.grasp_force = 1e5, Rejection::Implausible),
        (|u| u.header.clock = NOBODY, Rejection::Clock),
    ];
    for (index, (spoil, rejection)) in cases.into_iter().enumerate() {
        assert_eq!(spoiled_update(spoil), Err(rejection), "{index}");
    }
    // There is no finger 1.
    let mut hand = hand_with_state();
    let message = sound_update(&hand, 2);
    let refused = put(&mut hand, Topic::Tactile(1), &message, NOW);
    assert_eq!(refused, Err(Rejection::Size));
}

#[test]
fn malformed_messages_are_counted() {
    let mut hand = hand_with_state();
    let long = vec![0; Topic::State.most_bytes() + 1];
    let cut = &encode(&sound_state(&hand, 2)).unwrap()[..40];
    assert_eq!(
        hand.take(Topic::State, &long, NOW),
        Err(Rejection::Oversized)
    );
    assert_eq!(hand.take(Topic::State, cut, NOW), Err(Rejection::Malformed));
    assert_eq!(hand.take(Topic::Mode, &[], NOW), Err(Rejection::Stranger));
    assert_eq!(hand.rejected.total(), 3);
    assert_eq!(
        hand.rejected.to_string(),
        "1 too long, 1 malformed, 1 from unknown senders"
    );
}

#[test]
fn forged_sequence_numbers_do_not_lock_out_the_sender() {
    let mut hand = hand_with_state();
    for number in [u64::MAX, u64::MAX - 1, 1 << 40] {
        let forged = sound_state(&hand, number);
        let refused = put(&mut hand, Topic::State, &forged, NOW);
        assert_eq!(refused, Err(Rejection::Implausible));
    }
    let next = sound_state(&hand, 2);
    assert_eq!(put(&mut hand, Topic::State, &next, NOW), Ok(()));
}

/// The age follows from the echo of the exposure, not from the time of sending or arrival.
#[test]
fn age_is_bounded_by_the_echo() {
    let mut hand = hand_with_state();
    let late = 1.0 + STALE;
    let newer = StateMessage {
        header: MessageHeader {
            echo_age: 0.03,
            ..echoing(&hand.sent, WORLD, 2, 5.03)
        },
        ..sound_state(&hand, 2)
    };
    put(&mut hand, Topic::State, &newer, late).unwrap();
    let of_then = sound_update(&hand, 1);
    put(&mut hand, Topic::Tactile(0), &of_then, late).unwrap();
    assert_eq!(hand.stale(late - 1e-6, STALE), None);
    let stale = hand.stale(late + 1e-6, STALE);
    let Some(StopReason::StaleForces { finger: 0, age, .. }) = stale else {
        panic!("{stale:?}")
    };
    assert!((age - STALE - 1e-6).abs() < 1e-9, "{age} s");
}

#[test]
fn time_of_a_camera_with_a_separate_clock_follows_from_its_age() {
    let mut hand = hand_with_state();
    for (sequence, stamp) in [(1, -3.0), (2, 1e9)] {
        let own = TactileUpdate {
            header: MessageHeader {
                clock: SENSE,
                echo_age: 0.001 * sequence as f64,
                ..echoing(&hand.sent, SENSE, sequence, stamp)
            },
            ..sound_update(&hand, sequence)
        };
        put(&mut hand, Topic::Tactile(0), &own, NOW).unwrap();
        let time = hand.time_of(0);
        assert!(
            (time - 5.0 - 0.001 * sequence as f64).abs() < 1e-9,
            "{time} s"
        );
    }
}

/// A sensor that is faster than the control loop: its frames between two steps are kept once each, with their times.
#[test]
fn unread_frames_are_kept_with_their_times() {
    let hand = hand_with_state();
    let inbox = Shared::new(hand.clone());
    let mut finger = RemoteFinger::new(inbox.clone(), 0, ELEMENTS);
    let mut touch = TactileReading::none(ELEMENTS);
    let mut read = |numbers: std::ops::Range<u64>| -> Vec<(u64, f64, f64)> {
        for sequence in numbers {
            let mut fast = TactileUpdate {
                // Each frame arrives twice.
                frame: sequence / 2,
                header: MessageHeader {
                    clock: SENSE,
                    echo_age: 0.001 * (sequence / 2) as f64,
                    ..echoing(&hand.sent, SENSE, sequence, 0.0)
                },
                ..sound_update(&hand, sequence)
            };
            fast.forces[0] = x((sequence / 2) as f64);
            // After all frames were measured.
            let taken = put(&mut *inbox.lock(), Topic::Tactile(0), &fast, NOW + 0.01);
            taken.unwrap();
        }
        finger.touch(&mut touch).unwrap();
        let frames = finger.earlier_frames().iter().chain([&touch.frame]);
        let frames = frames.map(|f| (f.sequence, (f.stamp - 5.0) * 1e3, f.forces[0].x));
        frames.map(|(n, time, x)| (n, time.round(), x)).collect()
    };
    let frames = |numbers: std::ops::RangeInclusive<u64>| -> Vec<_> {
        numbers.map(|n| (n, n as f64, n as f64)).collect()
    };
    // Frames before the first control step are not of the run.
    assert_eq!(read(2..6), frames(2..=2));
    assert_eq!(read(6..14), frames(3..=6));
    // Nothing new.
    assert_eq!(read(0..0), frames(6..=6));
    assert_eq!(read(14..16), frames(7..=7));
}

#[test]
fn states_of_another_rig_continue_the_run_time() {
    let mut hand = hand_with_state();
    // The first rig has been silent for more than a second.
    for step in 101..=350 {
        hand.sent.sent(step, 0.01 * step as f64);
    }
    hear(&mut hand, &heartbeat("world", 20), 3.5).unwrap();
    let header = MessageHeader {
        clock: 20,
        echo_step: 350,
        echo_token: hand.sent.token(350),
        ..echoing(&hand.sent, 20, 1, 0.0)
    };
    put(&mut hand, Topic::State, &state(header), 3.501).unwrap();
    let time = hand.state().time;
    assert!((time - 5.0 - (3.501 - NOW)).abs() < 1e-9, "{time} s");
    let old = sound_update(&hand, 7);
    let refused = put(&mut hand, Topic::Tactile(0), &old, 3.502);
    assert_eq!(refused, Err(Rejection::Clock));
}

#[test]
fn stops_of_any_version_are_accepted_and_resumed_by_their_number() {
    let mut hand = hand();
    let stop = StopMessage {
        protocol: 77,
        from: "x".repeat(60_000),
        id: 5,
    };
    put(&mut hand, Topic::Stop, &stop, NOW).unwrap();
    let by = hand.holds.ordered_by().unwrap();
    assert_eq!(by.len(), 256);
    // Format of version 2, without an id.
    let mut earlier = vec![0, 1, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0];
    earlier.extend(b"me\0");
    assert_eq!(hand.take(Topic::Stop, &earlier, NOW), Ok(()));
    assert_eq!(
        hand.take(Topic::Stop, &[0, 1, 0, 0], NOW),
        Err(Rejection::Malformed)
    );
    let resume = |number, protocol| ResumeMessage {
        protocol,
        from: "me".into(),
        number,
    };
    let mut say = |number, protocol| put(&mut hand, Topic::Resume, &resume(number, protocol), NOW);
    assert_eq!(say(3, PROTOCOL), Err(Rejection::Old));
    assert_eq!(say(1, PROTOCOL + 1), Err(Rejection::Protocol));
    assert_eq!(say(1, PROTOCOL), Ok(()));
    assert_eq!(say(1, PROTOCOL), Err(Rejection::Old));
    assert_eq!(hand.holds.ordered_by(), Some("me"));
}

/// After a stop order has been given and resumed, a hand that was also stopped for stale data still resumes
/// automatically.
#[test]
fn automatic_resumption_works_after_a_resumed_order() {
    let mut hand = hand_with_state();
    let felt = sound_update(&hand, 1);
    put(&mut hand, Topic::Tactile(0), &felt, NOW).unwrap();
    assert_eq!(hand.verdict(NOW, STALE, true), Permission::Move);
    let late = hand.verdict(NOW + 1.0, STALE, true);
    assert!(matches!(
        late,
        Permission::ActiveStop(Some(StopReason::StaleState { .. }))
    ));
    let number = hand.holds.order(5, "me").unwrap();
    let told = hand.verdict(NOW, STALE, true);
    assert!(matches!(
        told,
        Permission::ActiveStop(Some(StopReason::Requested { .. }))
    ));
    hand.holds.resume(number);
    assert_eq!(hand.verdict(NOW, STALE, true), Permission::Move);
    // Without automatic resumption, both stops must be resumed.
    hand.verdict(NOW + 1.0, STALE, false);
    hand.holds.order(6, "me");
    hand.holds.resume(hand.holds.newest());
    assert_eq!(
        hand.verdict(NOW, STALE, false),
        Permission::ActiveStop(None)
    );
}

/// In lockstep data are never stale, but must have arrived: a hand that started earlier would wait for a rig that does
/// not know it yet.
#[test]
fn a_hand_starts_when_data_of_all_programs_have_arrived() {
    let mut hand = hand();
    let (now, never) = (1.0, f64::INFINITY);
    assert!(hand.missing(now).is_empty());
    assert!(!hand.may_begin(now, never));
    let state = sound_state(&hand, 1);
    put(&mut hand, Topic::State, &state, now).unwrap();
    assert!(!hand.may_begin(now, never));
    let felt = sound_update(&hand, 1);
    put(&mut hand, Topic::Tactile(0), &felt, now).unwrap();
    assert!(hand.may_begin(now, never));
}
