//! Time per call of the kinematics functions.

use divan::{Bencher, black_box};
use feeler::hand::chain::{Chain, ChainConfig, DhRow, JointConfig};
use feeler::hand::kinematics::{fingertip_pose, jacobian};
use feeler::hand::{FingerConfig, FingerGeometry, JointVector, inverse_kinematics, resolved_rate};
use glam::DVec3;

const THETA: [f64; 3] = [0.05, 0.9, -0.95];
const VELOCITY: DVec3 = DVec3::new(0.001, 0.01, 0.0005);

fn main() {
    divan::main();
}

fn geometry() -> FingerGeometry {
    FingerGeometry::new(&FingerConfig {
        base_position: [-0.144, 0.0, 0.06],
        phi1_deg: 0.0,
        phi2_deg: 0.0,
        links: [0.025, 0.05, 0.055],
        joint_lower_deg: [-45.0, 0.0, -120.0],
        joint_upper_deg: [45.0, 110.0, -15.0],
        joint_speed_limit: [3.0; 3],
    })
    .expect("the geometry above is within range")
}

#[divan::bench]
fn forward_kinematics(bencher: Bencher) {
    let geometry = geometry();
    let theta = JointVector::from(THETA);
    bencher.bench_local(|| fingertip_pose(black_box(&geometry), black_box(theta)));
}

#[divan::bench]
fn jacobian_matrix(bencher: Bencher) {
    let geometry = geometry();
    let theta = JointVector::from(THETA);
    bencher.bench_local(|| jacobian(black_box(&geometry), black_box(theta)));
}

#[divan::bench]
fn resolved_rate_undamped(bencher: Bencher) {
    let geometry = geometry();
    let theta = JointVector::from(THETA);
    bencher
        .bench_local(|| resolved_rate(black_box(&geometry), black_box(theta), black_box(VELOCITY)));
}

#[divan::bench]
fn resolved_rate_damped(bencher: Bencher) {
    let geometry = geometry();
    let straight = JointVector::from([0.05, 0.9, 0.0]);
    bencher.bench_local(|| {
        resolved_rate(
            black_box(&geometry),
            black_box(straight),
            black_box(VELOCITY),
        )
    });
}

/// Starts from joint angles one control period (10 ms) away, as in the control loop.
#[divan::bench]
fn inverse_kinematics_near(bencher: Bencher) {
    let geometry = geometry();
    let theta = JointVector::from(THETA);
    let target = fingertip_pose(&geometry, theta).0 + VELOCITY * 0.01;
    bencher.bench_local(|| {
        inverse_kinematics(black_box(&geometry), black_box(target), black_box(theta))
    });
}

/// Starts from joint angles at the other end of the workspace.
#[divan::bench]
fn inverse_kinematics_far(bencher: Bencher) {
    let geometry = geometry();
    let theta = JointVector::from(THETA);
    let target = fingertip_pose(&geometry, theta).0;
    let start = JointVector::from([-0.7, 0.1, -2.0]);
    bencher.bench_local(|| {
        inverse_kinematics(black_box(&geometry), black_box(target), black_box(start))
    });
}

/// A finger of four joints: one that spreads, three that bend, as in many robotic hands.
fn four_joints() -> Chain {
    let lengths_and_twists = [(0.015, 90.0), (0.054, 0.0), (0.038, 0.0), (0.027, 0.0)];
    let name = |index: usize| format!("joint {index}");
    let rows = lengths_and_twists.into_iter().enumerate();
    let config = ChainConfig {
        base_position: [0.0, 0.04, 0.1],
        base_rpy: [0.1, 0.2, 0.3],
        joints: (0..4)
            .map(|index| JointConfig {
                name: name(index),
                lower: -0.5,
                upper: 1.6,
                speed: 3.0,
            })
            .collect(),
        dh: rows
            .map(|(index, (a, alpha_deg))| DhRow {
                joint: Some(name(index)),
                a,
                alpha_deg,
                ..DhRow::default()
            })
            .collect(),
        frames: Vec::new(),
        tip_position: [0.0; 3],
        tip_rpy: [0.0; 3],
        damping_threshold: None,
    };
    Chain::new(&config).expect("the chain above is within range")
}

const FOUR_BENT: [f64; 4] = [0.1, 0.4, 0.7, 0.5];
const FOUR_STRAIGHT: [f64; 4] = [0.1, 0.4, 0.0, 0.0];

#[divan::bench]
fn chain_pose(bencher: Bencher) {
    let chain = four_joints();
    bencher.bench_local(|| black_box(&chain).pose(black_box(&FOUR_BENT)));
}

/// Pose, Jacobian and resolved rate, as in each control period.
#[divan::bench]
fn chain_control(bencher: Bencher) {
    chain_control_at(bencher, FOUR_BENT, VELOCITY);
}

#[divan::bench]
fn chain_control_damped(bencher: Bencher) {
    chain_control_at(bencher, FOUR_STRAIGHT, VELOCITY);
}

/// The spreading joint is at its limit and would move outward.
#[divan::bench]
fn chain_control_at_limit(bencher: Bencher) {
    let joints = [-0.5, 0.4, 0.7, 0.5];
    assert!(four_joints().resolved_rate(&joints, -VELOCITY).bounded[0]);
    chain_control_at(bencher, joints, -VELOCITY);
}

fn chain_control_at(bencher: Bencher, joints: [f64; 4], velocity: DVec3) {
    let chain = four_joints();
    bencher.bench_local(|| {
        let (chain, joints) = (black_box(&chain), black_box(&joints));
        let rate = chain.resolved_rate(joints, black_box(velocity));
        (chain.pose_and_jacobian(joints), rate)
    });
}

/// Starts from joint positions one control period (10 ms) away.
#[divan::bench]
fn chain_inverse_kinematics_near(bencher: Bencher) {
    let chain = four_joints();
    let target = chain.pose(&FOUR_BENT).0 + VELOCITY * 0.01;
    bencher.bench_local(|| {
        black_box(&chain).inverse_kinematics(black_box(target), black_box(&FOUR_BENT))
    });
}

/// Behind the finger, beyond the joint limits: all restarts are used.
#[divan::bench]
fn chain_inverse_kinematics_unreachable(bencher: Bencher) {
    let chain = four_joints();
    let base = DVec3::new(0.0, 0.04, 0.1);
    let target = base - 0.8 * (chain.pose(&FOUR_BENT).0 - base);
    assert!(chain.inverse_kinematics(target, &FOUR_BENT).is_err());
    bencher.bench_local(|| {
        black_box(&chain).inverse_kinematics(black_box(target), black_box(&FOUR_BENT))
    });
}
