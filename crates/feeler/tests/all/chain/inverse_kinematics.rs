//! Inverse kinematics of chains: round trips, and targets without a solution.

use super::{
    planar, random_joints, random_vector, reference_chain, reference_chains, references,
    within_limits,
};
use feeler::hand::POSITION_TOLERANCE;
use feeler::hand::chain::{Chain, ChainKinematicsError};
use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

const TARGETS: usize = 2_000;

/// Percentage of random reachable targets that are reached from random starts.
fn success_rate(chain: &Chain, rng: &mut Pcg64Mcg) -> f64 {
    let mut reached = 0;
    for _ in 0..TARGETS {
        let goal = random_joints(rng, chain);
        let start = random_joints(rng, chain);
        let target = chain.pose(&goal).0;
        if let Ok(joints) = chain.inverse_kinematics(target, &start) {
            let miss = chain.pose(&joints).0.distance(target);
            assert!(miss <= POSITION_TOLERANCE, "{miss:e} m");
            assert!(within_limits(chain, &joints), "{joints:?}");
            reached += 1;
        }
    }
    100.0 * f64::from(reached) / TARGETS as f64
}

#[test]
fn reachable_targets_are_reached() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    for (name, reference) in references() {
        let chain = Chain::new(&reference.config).unwrap();
        let rate = success_rate(&chain, &mut rng);
        println!("{name}: {rate} % of {TARGETS} targets");
        assert!(rate >= 99.9, "{name}: {rate} %");
    }
}

#[test]
fn a_reached_target_leaves_the_joints_unchanged() {
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    for chain in reference_chains() {
        for _ in 0..100 {
            let joints = random_joints(&mut rng, &chain);
            let target = chain.pose(&joints).0;
            assert_eq!(chain.inverse_kinematics(target, &joints), Ok(joints));
        }
    }
}

/// A nearby target changes the joints by not much more than the least-norm solution.
#[test]
fn a_near_target_keeps_the_posture() {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let chain = reference_chain("leap");
    for _ in 0..500 {
        let start = random_joints(&mut rng, &chain);
        let mut goal = start;
        goal[..4].iter_mut().for_each(|q| *q += 1e-3);
        if !within_limits(&chain, &goal) {
            continue;
        }
        let target = chain.pose(&goal).0;
        let found = chain.inverse_kinematics(target, &start).unwrap();
        let change = found.iter().zip(start).map(|(a, b)| (a - b).abs());
        assert!(change.fold(0.0, f64::max) < 0.05);
    }
}

#[test]
fn unreachable_targets_are_errors() {
    let chain = Chain::new(&planar(2)).unwrap();
    let far = chain.inverse_kinematics(DVec3::X, &[0.1, 0.2]).unwrap_err();
    assert_eq!(
        far.to_string(),
        "fingertip target [1, 0, 0] m is 1.000000 m from the first joint, expected at most 0.080000 m"
    );
    // Off the plane, the nearest point is 0.01 m away.
    let off = chain.inverse_kinematics(DVec3::new(0.05, 0.02, 0.01), &[0.1, 0.2]);
    match off.unwrap_err() {
        ChainKinematicsError::NotConverged { residual, .. } => {
            assert!((residual - 0.01).abs() < 1e-6, "{residual}");
        }
        other => panic!("{other}"),
    }
    for start in [&[0.1][..], &[0.1, f64::NAN]] {
        let missing = chain.inverse_kinematics(DVec3::X, start).unwrap_err();
        assert!(matches!(missing, ChainKinematicsError::NotFinite { .. }));
    }
}

/// A straight finger is a singularity, and reaches only the limit of the workspace.
#[test]
fn a_straight_finger_is_reached() {
    let chain = Chain::new(&planar(4)).unwrap();
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    for _ in 0..200 {
        let direction = random_vector(&mut rng).with_z(0.0).normalize();
        let start = random_joints(&mut rng, &chain);
        let target = direction * 0.16;
        if direction.x < -0.3 {
            continue; // beyond the limits of the first joint
        }
        let found = chain.inverse_kinematics(target, &start).unwrap();
        let bent = found
            .iter()
            .skip(1)
            .fold(0.0_f64, |most, q| most.max(q.abs()));
        // 1e-9 m short of 0.16 m: bends of the root of 2e-9 / 0.04.
        assert!(bent < 1e-3, "{found:?}");
    }
}
