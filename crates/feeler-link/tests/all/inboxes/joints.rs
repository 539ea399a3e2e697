//! Messages of fingers with other than three joints.

use super::bench::{WORLD, command, echoing, hand_with, put, rig_with, state};
use feeler::hand::{Hand, HandCommand, HandError, HandState, JointEfforts, JointVector};
use feeler_link::hand::RemoteHand;
use feeler_link::inboxes::Inbox;
use feeler_link::messages::message::CommandMessage;
use feeler_link::messages::{JointCounts, Rejection};
use feeler_link::transport::{LinkError, Outlet, Shared, Topic, monotonic};
use feeler_record::wire::{Vector3, cdr};
use std::sync::{Arc, Mutex};

/// Arrival time of messages (s).
const NOW: f64 = 1.002;

/// Vectors with the components 0.1, 0.2 and so on up to the joint number `joints`.
fn vectors(joints: usize) -> Vec<Vector3> {
    let value = |joint: usize| {
        if joint < joints {
            0.1 * (joint + 1) as f64
        } else {
            0.0
        }
    };
    let vectors = (0..joints.div_ceil(3)).map(|vector| Vector3 {
        x: value(3 * vector),
        y: value(3 * vector + 1),
        z: value(3 * vector + 2),
    });
    vectors.collect()
}

/// Joint quantities in [`vectors`].
fn values(joints: usize) -> JointVector {
    let values: Vec<_> = (1..=joints).map(|joint| 0.1 * joint as f64).collect();
    JointVector::from_slice(&values).unwrap()
}

/// Outlet that keeps the last message.
#[derive(Default)]
struct Kept(Mutex<Vec<u8>>);

impl Outlet for Kept {
    fn send(&self, _: Topic, bytes: Vec<u8>) -> Result<(), LinkError> {
        *self.0.lock().unwrap() = bytes;
        Ok(())
    }
}

#[test]
fn states_and_commands_have_all_joints() {
    for joints in 1..=7 {
        let mut inbox = hand_with(JointCounts::new([joints]));
        let mut message = state(echoing(&inbox.sent, WORLD, 1, 5.0));
        (message.position, message.velocity) = (vectors(joints), vectors(joints));
        put(&mut inbox, Topic::State, &message, NOW).unwrap();
        let sent = Arc::new(Kept::default());
        let mut hand = RemoteHand::new(Shared::new(inbox), sent.clone(), monotonic(), (0, 1));
        let mut state = HandState::zero(1);
        hand.read(&mut state).unwrap();
        let read = state.joints[0];
        assert_eq!(
            (read.position, read.velocity),
            (values(joints), values(joints))
        );
        assert_eq!((read.position.len(), read.velocity.len()), (joints, joints));
        let mut moving = HandCommand::stop(1);
        moving.relay(&[values(joints)]);
        for (command, expected) in [
            (
                HandCommand::stop(1),
                vec![Vector3::default(); joints.div_ceil(3)],
            ),
            (moving, vectors(joints)),
        ] {
            hand.command(&command).unwrap();
            let message: CommandMessage = cdr::decode(&sent.0.lock().unwrap()).unwrap();
            assert_eq!(message.joint_velocity, expected);
        }
        let mut many = HandCommand::stop(1);
        many.relay(&[JointVector::zeros(joints + 1)]);
        if joints < 7 {
            let refused = hand.command(&many).unwrap_err();
            assert!(matches!(refused, HandError::JointCount { expected, actual }
                if (expected, actual) == (joints, joints + 1)));
        }
        let mut rig = rig_with(JointCounts::new([joints]));
        let mut message = command(1, 0.0);
        message.joint_velocity = vectors(joints);
        put(&mut rig, Topic::Command, &message, 1.0).unwrap();
        assert_eq!(rig.drive(1.0, 0.1), Some(&[values(joints)][..]));
    }
}

/// Efforts of a finger with four joints, one of them unknown.
#[test]
fn efforts_arrive_and_remain_unknown_where_they_are() {
    let counts = JointCounts::new([4]);
    let mut inbox = hand_with(counts.clone());
    let efforts = JointEfforts {
        effort: [0.1, -0.2, f64::NAN, 0.4].into(),
        uncertainty: [0.01, 0.02, 0.0, 0.04].into(),
    };
    let mut message = state(echoing(&inbox.sent, WORLD, 1, 5.0));
    (message.position, message.velocity) = (vectors(4), vectors(4));
    let without = message.clone();
    (message.effort, message.effort_uncertainty) = counts.efforts_to_message(&[efforts]).unwrap();
    put(&mut inbox, Topic::State, &message, NOW).unwrap();
    let inbox = Shared::new(inbox);
    let outlet = Arc::new(Kept::default());
    let mut hand = RemoteHand::new(inbox.clone(), outlet, monotonic(), (0, 1));
    let mut state = HandState::zero(1);
    hand.read(&mut state).unwrap();
    let read = state.efforts[0];
    assert_eq!((read.effort[1], read.effort[3]), (-0.2, 0.4));
    assert!(read.effort[2].is_nan());
    assert_eq!(read.uncertainty, efforts.uncertainty);
    // The rig stops measuring them.
    let mut later = without;
    later.header.sequence += 1;
    put(&mut *inbox.lock(), Topic::State, &later, NOW).unwrap();
    hand.read(&mut state).unwrap();
    assert_eq!(state.efforts, [JointEfforts::default()]);
}

#[test]
fn a_finger_without_efforts_has_unknown_ones_beside_another() {
    let counts = JointCounts::new([1, 4]);
    let known = JointEfforts {
        effort: [0.1].into(),
        uncertainty: [0.01].into(),
    };
    let none = JointEfforts::default();
    assert_eq!(
        counts.efforts_to_message(&[none; 2]).unwrap(),
        (Vec::new(), Vec::new())
    );
    let (effort, _) = counts.efforts_to_message(&[known, none]).unwrap();
    let fingers: Vec<_> = counts.of_message(&effort).collect();
    assert_eq!(fingers[0], [0.1].into());
    assert!(fingers[1].iter().all(f64::is_nan) && fingers[1].len() == 4);
}

#[test]
fn other_numbers_of_joints_are_rejected_and_counted() {
    for joints in 1..=7_usize {
        for other in (0..=7_usize).filter(|&other| other != joints) {
            // A message does not contain the number of joints; missing ones within the last vector are 0.
            let same = other < joints && other.div_ceil(3) == joints.div_ceil(3);
            let expected = if same { Ok(()) } else { Err(Rejection::Size) };
            let mut rig = rig_with(JointCounts::new([joints]));
            let mut message = command(1, 0.0);
            message.joint_velocity = vectors(other);
            let taken = put(&mut rig, Topic::Command, &message, 1.0);
            assert_eq!(taken, expected, "{joints}, {other}");
            assert_eq!(rig.rejected.of(Rejection::Size), u64::from(!same));
            for spoiled in [0, 1] {
                let mut hand = hand_with(JointCounts::new([joints]));
                let mut message = state(echoing(&hand.sent, WORLD, 1, 5.0));
                (message.position, message.velocity) = (vectors(joints), vectors(joints));
                match spoiled {
                    0 => message.position = vectors(other),
                    _ => message.velocity = vectors(other),
                }
                let taken = put(&mut hand, Topic::State, &message, NOW);
                assert_eq!(taken, expected, "{joints}, {other}");
                assert_eq!(hand.rejected().of(Rejection::Size), u64::from(!same));
            }
        }
    }
}
