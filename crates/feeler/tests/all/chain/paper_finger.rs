//! The finger of three joints as a chain, compared with its closed form.

use super::{Joints, MAX_JOINTS, random_joints};
use feeler::hand::chain::{Chain, ChainConfig, DhRow, FrameRow, JointConfig};
use feeler::hand::kinematics::{fingertip_pose, jacobian};
use feeler::hand::{FingerConfig, FingerGeometry, JointVector, damping_threshold, resolved_rate};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::FRAC_PI_2;

fn config() -> FingerConfig {
    FingerConfig {
        base_position: [-0.144, 0.02, 0.06],
        phi1_deg: 30.0,
        phi2_deg: -20.0,
        links: [0.025, 0.05, 0.055],
        joint_lower_deg: [-180.0, -90.0, -150.0],
        joint_upper_deg: [180.0, 150.0, 60.0],
        joint_speed_limit: [3.0; 3],
    }
}

fn joints(config: &FingerConfig) -> Vec<JointConfig> {
    let joint = |index: usize| JointConfig {
        name: format!("theta{}", index + 1),
        lower: config.joint_lower_deg[index].to_radians(),
        upper: config.joint_upper_deg[index].to_radians(),
        speed: config.joint_speed_limit[index],
    };
    (0..3).map(joint).collect()
}

/// Base whose orientation `Ry(phi1) Rx(phi2)` is that of roll phi2 and pitch phi1.
fn based(config: &FingerConfig) -> ChainConfig {
    let geometry = FingerGeometry::new(config).unwrap();
    ChainConfig {
        base_position: config.base_position,
        base_rpy: [
            config.phi2_deg.to_radians(),
            config.phi1_deg.to_radians(),
            0.0,
        ],
        joints: joints(config),
        dh: Vec::new(),
        frames: Vec::new(),
        tip_position: [0.0; 3],
        tip_rpy: [0.0; 3],
        damping_threshold: Some(damping_threshold(&geometry)),
    }
}

/// Denavit-Hartenberg table of the finger.
fn table(config: &FingerConfig) -> Chain {
    let row = |index: usize, alpha_deg| DhRow {
        joint: Some(format!("theta{}", index + 1)),
        a: config.links[index],
        alpha_deg,
        ..DhRow::default()
    };
    Chain::new(&ChainConfig {
        dh: vec![row(0, 90.0), row(1, 0.0), row(2, 0.0)],
        ..based(config)
    })
    .unwrap()
}

/// Frames of the finger, with axes in other directions than z: joint 2 turns about -y of the finger's plane.
fn frames(config: &FingerConfig) -> Chain {
    let [l2, l3, l4] = config.links;
    let row = |index: usize, axis, length| FrameRow {
        joint: Some(format!("theta{}", index + 1)),
        xyz: [length, 0.0, 0.0],
        axis,
        ..FrameRow::default()
    };
    Chain::new(&ChainConfig {
        frames: vec![
            row(0, [0.0, 0.0, 2.0], 0.0),
            row(1, [0.0, -1.0, 0.0], l2),
            row(2, [0.0, -0.5, 0.0], l3),
        ],
        tip_position: [l4, 0.0, 0.0],
        tip_rpy: [FRAC_PI_2, 0.0, 0.0],
        ..based(config)
    })
    .unwrap()
}

/// Grid of 11 x 11 x 11 joint angles strictly within the limits, with straight fingers.
fn grid(geometry: &FingerGeometry) -> impl Iterator<Item = JointVector> {
    let (lower, upper) = (geometry.joint_lower(), geometry.joint_upper());
    (0..1331).map(move |i| {
        let share = [i % 11, i / 11 % 11, i / 121].map(|step| (f64::from(step) + 0.5) / 11.0);
        let mut theta =
            lower + (upper - lower).zip_with(share.into(), |range, share| range * share);
        if i / 121 == 7 {
            theta[2] = 0.0;
        }
        theta
    })
}

#[test]
fn pose_and_jacobian_are_those_of_the_closed_form() {
    let config = config();
    let geometry = FingerGeometry::new(&config).unwrap();
    for chain in [table(&config), frames(&config)] {
        for theta in grid(&geometry) {
            let (position, rotation) = chain.pose(theta.as_slice());
            let (expected, expected_rotation) = fingertip_pose(&geometry, theta);
            // Lengths below 0.2 m and six rotations.
            assert!(position.abs_diff_eq(expected, 1e-15), "{theta}");
            assert!(rotation.abs_diff_eq(expected_rotation, 1e-14), "{theta}");
            let [a, b, c, ..] = chain.jacobian(theta.as_slice());
            let expected = jacobian(&geometry, theta);
            for (column, expected) in [a, b, c].into_iter().zip(expected.columns()) {
                assert!(column.abs_diff_eq(*expected, 1e-15), "{theta}");
            }
        }
    }
}

#[test]
fn resolved_rate_is_that_of_the_closed_form() {
    let config = config();
    let geometry = FingerGeometry::new(&config).unwrap();
    let (mut damped, mut worst) = (0, 0.0_f64);
    for chain in [table(&config), frames(&config)] {
        for theta in grid(&geometry) {
            let velocity = DVec3::new(0.02, -0.03, 0.04);
            let expected = resolved_rate(&geometry, theta, velocity);
            let rate = chain.resolved_rate(theta.as_slice(), velocity);
            assert_eq!(rate.bounded, [false; MAX_JOINTS]);
            // lambda is the root of a difference, with a rounding error of 1e-16 of the largest singular value squared,
            // 0.13^2; joint velocities are at most 0.06 / 0.005 rad/s, times rounding and the condition number squared.
            let difference = (rate.damping.powi(2) - expected.damping.powi(2)).abs();
            assert!(difference < 1e-17, "{theta}: {difference:e}");
            let own = JointVector::from(rate.joint_velocity);
            worst = worst.max((own - expected.joint_velocity).length());
            damped += usize::from(expected.damping > 0.0);
        }
    }
    assert!(damped > 200, "{damped}");
    assert!(worst < 1e-11, "{worst:e}");
    println!("largest difference of joint velocities: {worst:e} rad/s");
}

/// Every target of a random posture within the limits is reached, from a random start.
#[test]
fn every_reachable_target_is_reached() {
    let config = config();
    let geometry = FingerGeometry::new(&config).unwrap();
    for chain in [table(&config), frames(&config)] {
        let thetas: Vec<_> = grid(&geometry).collect();
        for (index, theta) in thetas.iter().enumerate() {
            let target = fingertip_pose(&geometry, *theta).0;
            let start = thetas[index * 7 % thetas.len()];
            let found: Joints = chain.inverse_kinematics(target, start.as_slice()).unwrap();
            let miss = fingertip_pose(&geometry, found.into()).0 - target;
            assert!(miss.length() <= feeler::hand::POSITION_TOLERANCE);
        }
    }
}

/// Fingers of random proportions and limits. Many of their targets have several postures, only one within the limits.
#[test]
fn targets_of_random_fingers_are_reached() {
    let mut rng = Pcg64Mcg::seed_from_u64(10);
    let (mut reached, mut total) = (0, 0);
    for _ in 0..200 {
        let mut range = |low: f64, high: f64| rng.random_range(low..high);
        let config = FingerConfig {
            base_position: [range(-0.3, 0.3), range(-0.3, 0.3), 0.1],
            phi1_deg: range(-180.0, 180.0),
            phi2_deg: range(-180.0, 180.0),
            links: [range(0.001, 0.1), range(0.02, 0.1), range(0.02, 0.1)],
            joint_lower_deg: [
                range(-170.0, -20.0),
                range(-150.0, -10.0),
                range(-160.0, 0.0),
            ],
            joint_upper_deg: [range(20.0, 170.0), range(10.0, 150.0), range(0.0, 160.0)],
            joint_speed_limit: [3.0; 3],
        };
        let chain = table(&config);
        for _ in 0..20 {
            let target = chain.pose(&random_joints(&mut rng, &chain)).0;
            let start = random_joints(&mut rng, &chain);
            total += 1;
            reached += usize::from(chain.inverse_kinematics(target, &start).is_ok());
        }
    }
    println!("{reached} of {total} targets");
    assert_eq!(reached, total);
}
