//! Hands whose fingers have other than three joints.

#![cfg(target_os = "linux")]

use crate::support::MAX_AGE;
use feeler::hand::chain::ChainConfig;
use feeler::hand::{FingerGeometry, Hand, HandCommand, HandState, JointVector};
use feeler_drives::DriveError;
use feeler_drives::bus::Bus;
use feeler_drives::config::{DrivesConfig, JointDriveConfig};
use feeler_drives::emulator::{EmulatorConfig, LagPlant, Lockstep};
use feeler_drives::hand::DriveHand;
use feeler_drives::packet::Protocol;
use feeler_drives::registers::Registers;
use std::fmt::Write as _;

/// A planar chain with this number of revolute joints, the last one prismatic if `slides`.
fn finger(joints: usize, slides: bool) -> FingerGeometry {
    let (mut limits, mut rows) = (String::new(), String::new());
    for joint in 0..joints {
        let sliding = slides && joint + 1 == joints;
        let (kind, speed) = match sliding {
            true => ("prismatic", 0.1),
            false => ("revolute", 2.0),
        };
        writeln!(
            limits,
            "{{ name = \"j{joint}\", lower = -1.0, upper = 1.5, speed = {speed} }},"
        )
        .unwrap();
        writeln!(
            rows,
            "{{ type = \"{kind}\", joint = \"j{joint}\", a = 0.04 }},"
        )
        .unwrap();
    }
    let text = format!("base_position = [0.0, 0.0, 0.1]\njoints = [\n{limits}]\ndh = [\n{rows}]\n");
    let config: ChainConfig = toml::from_str(&text).unwrap();
    FingerGeometry::chain(&config).unwrap()
}

/// Opens a hand of these `fingers` on emulated servos, joint `i` of the hand at `0.01 i` rad.
fn open(
    config: &DrivesConfig,
    fingers: &[FingerGeometry],
) -> Result<(DriveHand, Lockstep), DriveError> {
    let joints = config.joints().enumerate();
    let angles = joints.map(|(i, joint)| joint.horn(0.01 * i as f64));
    let plant = LagPlant::new(0.01, &angles.collect::<Vec<_>>());
    let bus = Lockstep::new(&EmulatorConfig::of(config, 1), Box::new(plant));
    let how = (config.protocol, config.baud_rate);
    let master = Bus::on(
        Box::new(bus.clone()),
        how,
        config.reply_timeout,
        bus.clock(),
    );
    Ok((DriveHand::on(master, config, fingers, MAX_AGE)?, bus))
}

/// Servos for fingers with these numbers of revolute joints.
fn revolute(joints: &[usize]) -> DrivesConfig {
    let prismatic: Vec<_> = joints.iter().map(|&joints| vec![false; joints]).collect();
    DrivesConfig::emulated(&prismatic)
}

#[test]
fn a_finger_has_as_many_servos_as_joints() {
    let counts = [1, 4, 7];
    let fingers = counts.map(|joints| finger(joints, false));
    let config = revolute(&counts);
    assert!(config.joints().map(|joint| joint.id).eq(1..=12));
    let (mut hand, bus) = open(&config, &fingers).unwrap_or_else(|error| panic!("{error}"));
    let mut state = HandState::zero(3);
    hand.read(&mut state).unwrap();
    let angles = state.joints.iter().flat_map(|joints| joints.position);
    for (joint, angle) in angles.enumerate() {
        assert!(
            (angle - 0.01 * joint as f64).abs() < 2e-3,
            "{joint}: {angle}"
        );
    }
    let lengths = state.joints.iter().map(|joints| joints.position.len());
    assert!(lengths.eq(counts));
    // Only the last joint of each finger moves.
    let mut command = HandCommand::stop(3);
    let velocity = |joints: usize| {
        let mut velocity = JointVector::zeros(joints);
        velocity[joints - 1] = 0.5;
        velocity
    };
    command.relay(&counts.map(velocity));
    let before = state.clone();
    for _ in 0..20 {
        hand.read(&mut state).unwrap();
        hand.command(&command).unwrap();
        bus.wait(0.01);
    }
    hand.read(&mut state).unwrap();
    for (joints, (after, before)) in counts
        .into_iter()
        .zip(state.joints.iter().zip(&before.joints))
    {
        let moved = after.position - before.position;
        for (joint, moved) in moved.iter().enumerate() {
            let expected = if joint + 1 == joints { 0.095 } else { 0.0 };
            assert!((moved - expected).abs() < 0.01, "{joints} {joint}: {moved}");
        }
    }
    let refused = hand.jog(1, 4, 0.0).unwrap_err().to_string();
    let expected =
        "finger 1 and joint 5: expected a finger of the hand (from 0) and theta1 to theta4";
    assert_eq!(refused, expected);
    hand.jog(2, 6, 0.1).unwrap();
}

/// Two jaws of a parallel gripper, one of them with a rack on the other side of its pinion.
#[test]
fn a_servo_moves_a_prismatic_joint_by_its_travel_per_turn() {
    let jaws = [finger(1, true), finger(1, true)];
    let mut config = DrivesConfig::emulated(&[vec![true], vec![true]]);
    config.finger[1].joint[0].direction = -1;
    config.finger[1].joint[0].travel_per_turn = Some(0.1);
    let (mut hand, bus) = open(&config, &jaws).unwrap_or_else(|error| panic!("{error}"));
    let mut state = HandState::zero(2);
    hand.read(&mut state).unwrap();
    let begin = [0, 1].map(|jaw| state.joints[jaw].position[0]);
    assert!((begin[1] - 0.01).abs() < 2e-5, "{begin:?}");
    let counts = |servo: usize| {
        let bus = bus.servos();
        bus.servos()[servo].get(Registers::of(Protocol::Dynamixel).position)
    };
    let before = [counts(0), counts(1)];
    let mut command = HandCommand::stop(2);
    command.relay(&[JointVector::splat(1, 0.02); 2]);
    for _ in 0..50 {
        hand.read(&mut state).unwrap();
        hand.command(&command).unwrap();
        bus.wait(0.01);
    }
    command.relay(&[JointVector::splat(1, 0.0); 2]);
    hand.command(&command).unwrap();
    bus.wait(0.05);
    hand.read(&mut state).unwrap();
    for (jaw, (travel, sign)) in [(0.04, 1.0), (0.1, -1.0)].into_iter().enumerate() {
        let moved = state.joints[jaw].position[0] - begin[jaw];
        assert!((moved - 0.01).abs() < 5e-4, "{jaw}: {moved} m");
        let turns = (counts(jaw) - before[jaw]) as f64 / 4096.0;
        // To within the noise of the encoder, a count.
        assert!(
            (turns - sign * moved / travel).abs() < 1e-3,
            "{jaw}: {turns} turns for {moved} m"
        );
    }
    hand.jog(0, 0, 0.005).unwrap();
    let refused = hand.jog(0, 0, 0.1).unwrap_err().to_string();
    assert!(
        refused.contains("0.1 m/s: expected at most 0.01 m/s"),
        "{refused}"
    );
}

#[test]
fn keys_of_another_kind_of_joint_are_refused() {
    let refused = |slides: bool, change: &dyn Fn(&mut JointDriveConfig)| {
        let mut config = DrivesConfig::emulated(&[vec![slides]]);
        change(&mut config.finger[0].joint[0]);
        let error = open(&config, &[finger(1, slides)]).err();
        error.expect("an error").to_string()
    };
    assert_eq!(
        refused(true, &|joint| joint.travel_per_turn = None),
        "drives.finger[0].joint[0] = a servo without travel_per_turn: expected travel_per_turn in m, as the joint is prismatic"
    );
    assert_eq!(
        refused(true, &|joint| joint.gear_ratio = 2.0),
        "drives.finger[0].joint[0].gear_ratio = 2: expected 1 with travel_per_turn, which includes any gear"
    );
    assert_eq!(
        refused(false, &|joint| joint.travel_per_turn = Some(0.04)),
        "drives.finger[0].joint[0].travel_per_turn = 0.04: expected none, as the joint is revolute; use gear_ratio"
    );
}

#[test]
fn other_numbers_of_servos_are_refused() {
    let refused = |servos: usize, finger: FingerGeometry| {
        let error = open(&revolute(&[servos]), &[finger]).err();
        error.expect("an error").to_string()
    };
    assert_eq!(
        refused(3, finger(4, false)),
        "drives.finger[0].joint = 3 joints: expected 4 joints, theta1 to theta4"
    );
    assert_eq!(
        refused(2, finger(1, false)),
        "drives.finger[0].joint = 2 joints: expected 1 joint, theta1"
    );
    assert_eq!(
        refused(4, crate::support::finger()),
        "drives.finger[0].joint = 4 joints: expected 3 joints, theta1 to theta3"
    );
}
