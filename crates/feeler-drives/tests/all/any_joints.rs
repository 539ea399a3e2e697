//! Hands whose fingers have other than three joints.

#![cfg(target_os = "linux")]

use crate::support::MAX_AGE;
use feeler::hand::chain::ChainConfig;
use feeler::hand::{FingerGeometry, Hand, HandCommand, HandState, JointVector};
use feeler_drives::DriveError;
use feeler_drives::bus::Bus;
use feeler_drives::config::DrivesConfig;
use feeler_drives::emulator::{EmulatorConfig, LagPlant, Lockstep};
use feeler_drives::hand::DriveHand;
use feeler_drives::registers::COUNTS_PER_TURN;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// A planar chain with this number of revolute joints, the last one prismatic if `slides`.
fn finger(joints: usize, slides: bool) -> FingerGeometry {
    let (mut limits, mut rows) = (String::new(), String::new());
    for joint in 0..joints {
        let sliding = slides && joint + 1 == joints;
        let kind = if sliding { "prismatic" } else { "revolute" };
        writeln!(
            limits,
            "{{ name = \"j{joint}\", lower = -1.0, upper = 1.5, speed = 2.0 }},"
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
    let angles = joints.map(|(i, joint)| joint.counts(0.01 * i as f64) / COUNTS_PER_TURN * TAU);
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

#[test]
fn a_finger_has_as_many_servos_as_joints() {
    let counts = [1, 4, 7];
    let fingers = counts.map(|joints| finger(joints, false));
    let config = DrivesConfig::emulated(&counts);
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

#[test]
fn other_numbers_of_servos_and_prismatic_joints_are_refused() {
    let refused = |servos: usize, finger: FingerGeometry| {
        let error = open(&DrivesConfig::emulated(&[servos]), &[finger]).err();
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
    assert_eq!(
        refused(2, finger(2, true)),
        "drives.finger[0].joint[1] = a servo on a prismatic joint: expected a revolute joint of hand.finger: positions of \
         servos are angles"
    );
}
