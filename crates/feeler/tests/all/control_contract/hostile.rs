//! With any input, the controller does not panic and its commands are finite and within limits.

use super::rig::{Analyzers, ELEMENTS, config, controller, geometries, home};
use feeler::control::Phase;
use feeler::hand::{HandCommand, HandState, JointEfforts, JointState, JointVector, MAX_JOINTS};
use feeler::sensor::forces::TactileFrame;
use glam::DVec3;
use proptest::prelude::*;

/// Mostly plausible numbers, and extreme ones.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        40 => -2.0..2.0,
        4 => Just(0.0),
        1 => prop_oneof![
            Just(f64::NAN),
            Just(f64::INFINITY),
            Just(f64::NEG_INFINITY),
            Just(f64::MAX),
            Just(f64::MIN),
            Just(f64::MIN_POSITIVE),
            any::<f64>(),
        ],
    ]
}

fn vector() -> impl Strategy<Value = DVec3> {
    [number(), number(), number()].prop_map(DVec3::from_array)
}

fn joints() -> impl Strategy<Value = JointVector> {
    [number(), number(), number()].prop_map(JointVector::from)
}

/// Forces of a frame: one value for all elements except one, so that most frames are valid.
fn forces() -> impl Strategy<Value = Vec<DVec3>> {
    let count = prop_oneof![30 => Just(ELEMENTS), 1 => 0..50_usize];
    (count, -0.1..2.0_f64, vector()).prop_map(|(count, all, one)| {
        let mut forces = vec![DVec3::Z * all; count];
        if let Some(first) = forces.first_mut() {
            *first = one;
        }
        forces
    })
}

fn stamp() -> impl Strategy<Value = f64> {
    prop_oneof![30 => -0.02..0.02, 1 => number()]
}

#[derive(Debug, Clone)]
struct Input {
    sequence: Vec<u64>,
    forces: Vec<Vec<DVec3>>,
    /// Offsets of the stamps from their nominal time (s).
    stamps: Vec<f64>,
    state_stamp: f64,
    /// Offsets of the joints from home (rad).
    joints: Vec<JointVector>,
    efforts: Vec<JointEfforts>,
}

/// Efforts of one finger, of any numbers of joints.
fn efforts() -> impl Strategy<Value = JointEfforts> {
    let numbers = || prop::collection::vec(number(), 0..=MAX_JOINTS);
    (numbers(), numbers()).prop_map(|(effort, uncertainty)| {
        let [effort, uncertainty] = [effort, uncertainty].map(|v| JointVector::from_slice(&v));
        JointEfforts {
            effort: effort.expect("few joints"),
            uncertainty: uncertainty.expect("few joints"),
        }
    })
}

fn input() -> impl Strategy<Value = Input> {
    let fingers = || prop_oneof![60 => Just(2), 1 => 0..4_usize];
    (
        prop::collection::vec(0..50_u64, 4),
        fingers().prop_flat_map(|n| prop::collection::vec(forces(), n)),
        prop::collection::vec(stamp(), 4),
        stamp(),
        fingers().prop_flat_map(|n| prop::collection::vec(joints(), n)),
        prop::collection::vec(efforts(), 0..4),
    )
        .prop_map(
            |(sequence, forces, stamps, state_stamp, joints, efforts)| Input {
                sequence,
                forces,
                stamps,
                state_stamp,
                joints,
                efforts,
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn commands_are_finite_and_within_limits_for_any_input(
        inputs in prop::collection::vec(input(), 1..40)
    ) {
        let config = config();
        let (mut controller, home) = (controller(&config), home(&config));
        let limits: Vec<_> = geometries(&config).iter().map(|g| g.joint_speed_limit()).collect();
        let most_change = config.control.limits.joint_acceleration * config.control.period;
        let mut analyzers = Analyzers::new(&config);
        let (mut command, mut before) = (HandCommand::stop(2), HandCommand::stop(2));
        for (n, input) in inputs.iter().enumerate() {
            let now = 0.01 * n as f64;
            let frames = input.forces.iter().zip(&input.stamps).zip(&input.sequence);
            let frames: Vec<_> = frames
                .map(|((forces, stamp), &sequence)| TactileFrame {
                    sequence,
                    stamp: now + stamp,
                    forces: forces.clone(),
                })
                .collect();
            let joints = input.joints.iter().zip(home.iter().cycle());
            let state = HandState {
                stamp: now + input.state_stamp,
                joints: joints
                    .map(|(&off, &home)| JointState { position: home + off, velocity: off })
                    .collect(),
                efforts: input.efforts.clone(),
            };
            controller.decide(&analyzers.touches(&frames), &state, &mut command);
            prop_assert_eq!(command.joint_velocity().len(), 2);
            let stopped = controller.stop_reason().is_some();
            prop_assert_eq!(stopped, controller.phase() == Phase::Stopped);
            let velocities = command.joint_velocity().iter().zip(before.joint_velocity());
            for ((&velocity, &previous), limit) in velocities.zip(&limits) {
                prop_assert!(velocity.is_finite());
                if stopped {
                    prop_assert_eq!(velocity, JointVector::default());
                    continue;
                }
                // Rounding of a sum of two numbers of at most 2 rad/s.
                prop_assert!((velocity.abs() - *limit).max_element() <= 1e-15, "{}", velocity);
                let change = (velocity - previous).abs().max_element();
                prop_assert!(change <= most_change + 1e-15, "{} rad/s", change);
            }
            before.clone_from(&command);
        }
    }
}
