//! Random chains and extreme arguments: results are finite, and joints within their limits.

use super::within_limits;
use assert_no_alloc::assert_no_alloc;
use feeler::hand::chain::{
    Chain, ChainConfig, FrameRow, JointConfig, MAX_JOINTS, MimicConfig, RowType,
};
use glam::DVec3;
use proptest::prelude::*;

/// Any finite number, including the largest ones and subnormals.
fn finite() -> impl Strategy<Value = f64> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![
        POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO,
        -2.0..2.0_f64,
        Just(f64::MAX),
        Just(f64::MIN),
    ]
}

fn joint(index: usize) -> impl Strategy<Value = JointConfig> {
    let lower = prop_oneof![Just(-100.0), -2.0..2.0_f64];
    let range = prop_oneof![Just(1e-9), 0.01..3.0_f64];
    (lower, range).prop_map(move |(lower, range)| JointConfig {
        name: index.to_string(),
        lower,
        upper: lower + range,
        speed: 1.0,
    })
}

fn length() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), -0.1..0.1_f64, Just(10.0), Just(1e-300)]
}

/// Angles, many of them right, so that axes are parallel or intersect.
fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(0.0),
        Just(std::f64::consts::FRAC_PI_2),
        -10.0..10.0_f64
    ]
}

fn row(joints: usize) -> impl Strategy<Value = FrameRow> {
    let axis = prop::array::uniform3(-1.0..1.0_f64).prop_filter("long enough", |axis| {
        DVec3::from_array(*axis).length() > 0.01
    });
    let axis = prop_oneof![Just([1.0, 0.0, 0.0]), Just([0.0, 0.0, -500.0]), axis];
    let mimic = (
        0..joints,
        prop_oneof![0.1..2.0_f64, Just(-100.0)],
        -1.0..1.0_f64,
    );
    let vector = || prop::array::uniform3(length());
    let kind = prop_oneof![3 => Just(RowType::Revolute), 1 => Just(RowType::Prismatic)];
    (kind, mimic, vector(), prop::array::uniform3(angle()), axis).prop_map(
        |(row_type, (joint, multiplier, offset), xyz, rpy, axis)| FrameRow {
            row_type,
            joint: None,
            mimic: Some(MimicConfig {
                joint: joint.to_string(),
                multiplier,
                offset,
            }),
            xyz,
            rpy,
            axis,
        },
    )
}

/// Chains of random rows. Rows of joints that no other row uses come first.
fn chain() -> impl Strategy<Value = ChainConfig> {
    (1..=MAX_JOINTS).prop_flat_map(|joints| {
        let list: Vec<_> = (0..joints).map(joint).collect();
        let rows = prop::collection::vec(row(joints), joints..=16);
        let tip = prop::array::uniform3(length());
        (list, rows, tip).prop_map(|(joints, mut frames, tip_position)| {
            for (index, row) in frames.iter_mut().enumerate().take(joints.len()) {
                (row.mimic, row.joint) = (None, Some(index.to_string()));
            }
            ChainConfig {
                base_position: [100.0, 0.0, -3.0],
                base_rpy: [0.1, 0.2, 0.3],
                joints,
                dh: Vec::new(),
                frames,
                tip_position,
                tip_rpy: [0.0; 3],
                damping_threshold: None,
            }
        })
    })
}

fn vector() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(finite()).prop_map(DVec3::from_array)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn finite_arguments_give_finite_results(
        config in chain(),
        joints in prop::array::uniform7(finite()),
        velocity in vector(),
    ) {
        let Ok(chain) = Chain::new(&config) else { return Ok(()) };
        assert_no_alloc(|| {
            let (position, rotation) = chain.pose(&joints);
            assert!(position.is_finite() && rotation.is_finite());
            assert!(chain.jacobian(&joints).iter().all(|column| column.is_finite()));
            let rate = chain.resolved_rate(&joints, velocity);
            assert!(rate.joint_velocity.iter().all(|v| v.is_finite()));
            assert!((0.0..=chain.damping_threshold()).contains(&rate.damping));
        });
    }

    #[test]
    fn bounds_are_kept(
        config in chain(),
        joints in prop::array::uniform7(finite()),
        velocity in vector(),
        bounds in prop::array::uniform7((finite(), finite())),
    ) {
        let Ok(chain) = Chain::new(&config) else { return Ok(()) };
        let bounds = bounds.map(|(a, b)| [a.min(b).min(0.0), a.max(b).max(0.0)]);
        let rate = chain.resolved_rate_within(&joints, velocity, &bounds);
        for (v, [lowest, highest]) in rate.joint_velocity.into_iter().zip(bounds) {
            prop_assert!((lowest..=highest).contains(&v), "{} {} {}", v, lowest, highest);
        }
        let stopped = chain.resolved_rate_within(&joints, velocity, &[[f64::NAN; 2]; MAX_JOINTS]);
        prop_assert_eq!(stopped.joint_velocity, [0.0; MAX_JOINTS]);
    }

    #[test]
    fn solutions_are_within_the_limits(
        config in chain(),
        joints in prop::array::uniform7(finite()),
        direction in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let Ok(chain) = Chain::new(&config) else { return Ok(()) };
        let base = DVec3::from_array(config.base_position);
        for target in [base + DVec3::from_array(direction) * chain.reach(), DVec3::MAX] {
            if let Ok(found) = chain.inverse_kinematics(target, &joints) {
                prop_assert!(within_limits(&chain, &found));
                // The position has rounding errors of 100 m.
                prop_assert!(chain.pose(&found).0.distance(target) <= 1e-9 + 1e-13);
            }
        }
    }

    #[test]
    fn joint_velocity_is_bounded(
        config in chain(),
        joints in prop::array::uniform7(-3.0..3.0_f64),
        velocity in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let Ok(chain) = Chain::new(&config) else { return Ok(()) };
        let velocity = DVec3::from_array(velocity);
        let rate = chain.resolved_rate(&joints, velocity);
        let prismatic = chain.is_prismatic();
        let squares = rate.joint_velocity.iter().zip(prismatic).map(|(v, prismatic)| {
            (v / if prismatic { chain.reach() } else { 1.0 }).powi(2)
        });
        let joints = chain.joint_count() as f64;
        let bound = 1.0 / chain.damping_threshold() + 0.5 * joints.sqrt() / chain.reach();
        // Rounding of a system with condition number squared of 1e6 at most.
        prop_assert!(squares.sum::<f64>().sqrt() <= velocity.length() * bound * (1.0 + 1e-9));
    }
}
