//! Poses and Jacobians compared with Pinocchio and with finite differences.

use super::{random_joints, reference_chains, references};
use assert_no_alloc::assert_no_alloc;
use feeler::hand::chain::Chain;
use glam::{DMat3, DVec3};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Lengths below 1 m and products of at most ten rotations, each with rounding errors of a few 1e-16, on both sides.
const TOLERANCE: f64 = 1e-14;

#[test]
fn pose_and_jacobian_agree_with_pinocchio() {
    let mut worst = [0.0_f64; 3];
    for (name, reference) in references() {
        let chain = Chain::new(&reference.config).unwrap();
        assert_eq!(reference.samples.len(), 16);
        for sample in reference.samples {
            let (position, rotation) = assert_no_alloc(|| chain.pose(&sample.joints));
            let jacobian = assert_no_alloc(|| chain.jacobian(&sample.joints));
            let both = assert_no_alloc(|| chain.pose_and_jacobian(&sample.joints));
            assert_eq!(both, (position, rotation, jacobian));
            let expected = DMat3::from_cols_array(&sample.rotation);
            let columns = sample.jacobian.chunks_exact(3).map(DVec3::from_slice);
            assert_eq!(columns.len(), chain.joint_count());
            let column = columns
                .zip(jacobian)
                .map(|(a, b)| (a - b).abs().max_element());
            let rotated = (rotation - expected).abs().to_cols_array();
            let differences = [
                (position - sample.position).abs().max_element(),
                rotated.into_iter().fold(0.0, f64::max),
                column.fold(0.0, f64::max),
            ];
            for (worst, difference) in worst.iter_mut().zip(differences) {
                assert!(difference < TOLERANCE, "{name}: {differences:?}");
                *worst = worst.max(difference);
            }
            let unused = jacobian.iter().skip(chain.joint_count());
            assert!(unused.into_iter().all(|column| *column == DVec3::ZERO));
        }
    }
    println!("largest differences of position (m), rotation and Jacobian: {worst:?}");
}

#[test]
fn jacobian_agrees_with_central_differences() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    for chain in reference_chains() {
        for _ in 0..100 {
            let joints = random_joints(&mut rng, &chain);
            let jacobian = chain.jacobian(&joints);
            for joint in 0..chain.joint_count() {
                let at = |step: f64| {
                    let mut moved = joints;
                    moved[joint] += step;
                    chain.pose(&moved).0
                };
                let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
                let difference = (slope - jacobian[joint]).length();
                // Truncation: 1e-10 / 6 times the third derivative, below 1 m/rad^3 with multipliers; rounding of
                // lengths below 1 m: 1e-16 / 1e-5.
                assert!(difference < 1e-10, "{difference:e}");
            }
        }
    }
}
