//! Resolved rate control compared with nalgebra's singular value decomposition.

use super::{
    Joints, fingertip_velocity, planar, random_joints, random_vector, reference_chain,
    reference_chains,
};
use assert_no_alloc::assert_no_alloc;
use feeler::hand::chain::{Chain, MAX_JOINTS};
use glam::DVec3;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Jacobian with columns of displacements multiplied by the reach.
fn scaled_jacobian(chain: &Chain, joints: &Joints) -> DMatrix<f64> {
    let (columns, scale) = (chain.jacobian(joints), scale(chain));
    DMatrix::from_fn(3, chain.joint_count(), |row, joint| {
        columns[joint][row] * scale[joint]
    })
}

fn scale(chain: &Chain) -> Joints {
    let one = |prismatic| if prismatic { chain.reach() } else { 1.0 };
    chain.is_prismatic().map(one)
}

fn scaled_velocity(chain: &Chain, velocity: &Joints) -> DVector<f64> {
    let scale = scale(chain);
    DVector::from_fn(chain.joint_count(), |joint, _| {
        velocity[joint] / scale[joint]
    })
}

/// Away from limits and singularities, the part of the joint velocity that moves the fingertip is the pseudo-inverse's,
/// and the remainder is in the null space.
#[test]
fn task_velocity_is_that_of_the_pseudo_inverse() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let mut chains = reference_chains();
    chains.extend((1..=7).map(|joints| Chain::new(&planar(joints)).unwrap()));
    let mut undamped = 0;
    for chain in chains {
        for _ in 0..300 {
            let joints = random_joints(&mut rng, &chain);
            let velocity = random_vector(&mut rng) * 0.1;
            let rate = assert_no_alloc(|| chain.resolved_rate(&joints, velocity));
            if rate.damping > 0.0 {
                continue;
            }
            undamped += 1;
            let jacobian = scaled_jacobian(&chain, &joints);
            // Directions in which the fingertip cannot move have singular values of rounding errors.
            let inverse = jacobian.clone().pseudo_inverse(1e-9).unwrap();
            let expected = &inverse * DVector::from_row_slice(&velocity.to_array());
            let own = scaled_velocity(&chain, &rate.joint_velocity);
            let rest = &own - &expected;
            // Defining property of the least-squares solution: the error is orthogonal to all columns. `J J^T` has a
            // condition number below 1e4, and rest / |v| a norm below 1e3 with columns of 1 m/rad.
            let goal = DVector::from_row_slice(&velocity.to_array());
            let orthogonal = (jacobian.transpose() * (&jacobian * &own - goal)).norm();
            assert!(orthogonal < 1e-12 * velocity.length(), "{orthogonal:e}");
            // Nalgebra's singular vectors have errors of 1e-13.
            let moved = (&jacobian * &rest).norm();
            assert!(moved < 1e-11 * velocity.length(), "{moved:e}");
            let along = (&inverse * &jacobian * &rest).norm();
            assert!(along < 1e-11 * expected.norm(), "{along:e}");
            let bound = 0.5 * velocity.length() * (MAX_JOINTS as f64).sqrt() / chain.reach();
            assert!(rest.norm() <= bound);
        }
    }
    assert!(undamped > 2000, "{undamped}");
}

/// The fingertip velocity does not depend on the self-motion, also near singularities.
#[test]
fn damped_task_velocity_is_that_of_the_singular_values() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut damped = 0;
    for chain in reference_chains() {
        let epsilon = chain.damping_threshold();
        for _ in 0..1000 {
            let joints = random_joints(&mut rng, &chain);
            let velocity = random_vector(&mut rng) * 0.1;
            let rate = chain.resolved_rate(&joints, velocity);
            let svd = scaled_jacobian(&chain, &joints).svd(true, true);
            let u = svd.u.unwrap();
            let sigma = svd.singular_values.min();
            let lambda2 = (epsilon * epsilon - sigma * sigma).max(0.0);
            assert!((rate.damping.powi(2) - lambda2).abs() < 1e-15);
            damped += usize::from(lambda2 > 0.0);
            let goal = DVector::from_row_slice(&velocity.to_array());
            let gains = svd.singular_values.map(|s| s * s / (s * s + lambda2));
            let expected = &u * gains.component_mul(&(u.transpose() * goal));
            let own = fingertip_velocity(&chain, &joints, &rate.joint_velocity);
            let expected = DVec3::from_slice(expected.as_slice());
            let difference = (own - expected).length();
            // Velocities below 0.2 m/s, with condition number squared below 1e4.
            assert!(difference < 1e-12, "{difference:e}");
        }
    }
    assert!(damped > 50, "{damped}");
}

/// Joint velocity on a line of joint positions through the threshold of damping and through the singularity.
#[test]
fn joint_velocity_is_continuous_at_thresholds_and_singularities() {
    let chain = reference_chain("allegro");
    let at = |bend: f64| {
        let joints = [0.2, 0.9, bend, -0.5 * bend];
        chain.resolved_rate(&joints, DVec3::new(0.05, -0.02, 0.04))
    };
    let (mut previous, mut changes, mut damped) = (at(-0.1), 0, false);
    for step in 1..=40_000 {
        let next = at(-0.1 + 1e-5 * f64::from(step));
        changes += usize::from((next.damping > 0.0) != damped);
        damped = next.damping > 0.0;
        for (a, b) in next.joint_velocity.into_iter().zip(previous.joint_velocity) {
            // The slope is at most |v| reach / epsilon^2 = 500 /s, and that of lambda is its largest at the threshold.
            assert!((a - b).abs() < 1e-5 * 2000.0, "{a} {b} at step {step}");
        }
        previous = next;
    }
    assert!(changes >= 2, "{changes}");
}

#[test]
fn fingers_of_few_joints_do_the_nearest_velocity() {
    let gripper = reference_chain("gripper");
    let axis = gripper.jacobian(&[0.02])[0];
    let sideways = axis.any_orthonormal_vector();
    let rate = gripper.resolved_rate(&[0.02], axis * 0.05 + sideways * 0.3);
    // One product and quotient.
    assert!((rate.joint_velocity[0] - 0.05).abs() < 1e-16);
    assert_eq!(rate.damping, 0.0);
}

/// A planar chain cannot move in z at any joint position, which is not a singularity.
#[test]
fn directions_that_no_joint_moves_are_not_damped() {
    for joints in 2..=7 {
        let chain = Chain::new(&planar(joints)).unwrap();
        let bent = [0.9; MAX_JOINTS];
        let velocity = DVec3::new(0.03, -0.05, 0.2);
        let rate = chain.resolved_rate(&bent, velocity);
        assert_eq!(rate.damping, 0.0);
        let moved = fingertip_velocity(&chain, &bent, &rate.joint_velocity);
        let expected = DVec3::new(0.03, -0.05, 0.0);
        assert!(moved.abs_diff_eq(expected, 1e-14), "{moved}");
    }
}

#[test]
fn nan_is_not_hidden() {
    for chain in reference_chains() {
        let count = chain.joint_count();
        let joints = [0.01; MAX_JOINTS];
        let bad = [DVec3::new(0.0, f64::NAN, 0.0), DVec3::splat(f64::INFINITY)];
        for velocity in bad {
            let rate = chain.resolved_rate(&joints, velocity);
            assert!(rate.joint_velocity.iter().take(count).all(|v| v.is_nan()));
        }
        for index in 0..count {
            for value in [f64::NAN, f64::NEG_INFINITY] {
                let mut bad = joints;
                bad[index] = value;
                let rate = chain.resolved_rate(&bad, DVec3::X);
                assert!(rate.joint_velocity.iter().take(count).all(|v| v.is_nan()));
                assert!(chain.pose(&bad).0.is_nan());
            }
        }
        // A joint is missing.
        let rate = chain.resolved_rate(&joints[..count - 1], DVec3::X);
        assert!(rate.joint_velocity[0].is_nan());
        assert!(chain.pose(&joints[..count - 1]).0.is_nan());
    }
}
