//! Finger kinematics compared with independent methods: a Denavit-Hartenberg chain, finite differences, and a general
//! linear solver.

use assert_no_alloc::assert_no_alloc;
use feeler::hand::kinematics::{fingertip_pose, jacobian};
use feeler::hand::{
    FingerConfig, FingerGeometry, JointVector, KinematicsError, POSITION_TOLERANCE,
    damping_threshold, inverse_kinematics, resolved_rate,
};
use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, Matrix4, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const POSES: usize = 1_000;

fn random_vector(rng: &mut Pcg64Mcg, lower: [f64; 3], upper: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| rng.random_range(lower[i]..upper[i]))
}

/// A finger with random base pose, proportions and joint limits; many targets are reachable in several postures.
fn random_config(rng: &mut Pcg64Mcg) -> FingerConfig {
    FingerConfig {
        base_position: random_vector(rng, [-0.3; 3], [0.3; 3]),
        phi1_deg: rng.random_range(-180.0..180.0),
        phi2_deg: rng.random_range(-180.0..180.0),
        links: random_vector(rng, [0.0, 0.02, 0.02], [0.1; 3]).map(|l| l.max(1e-3)),
        joint_lower_deg: random_vector(rng, [-170.0, -150.0, -160.0], [-20.0, -10.0, 0.0]),
        joint_upper_deg: random_vector(rng, [20.0, 10.0, 0.0], [170.0, 150.0, 160.0]),
        joint_speed_limit: [3.0; 3],
    }
}

fn random_geometry(rng: &mut Pcg64Mcg) -> FingerGeometry {
    FingerGeometry::new(&random_config(rng)).unwrap()
}

/// Joint angles within the joint limits.
fn random_theta(rng: &mut Pcg64Mcg, geometry: &FingerGeometry) -> JointVector {
    let lower = geometry.joint_lower().to_array().unwrap();
    let upper = geometry.joint_upper().to_array().unwrap();
    JointVector::from(random_vector(rng, lower, upper))
}

/// Joint angles over the full turn, regardless of limits.
fn any_theta(rng: &mut Pcg64Mcg) -> JointVector {
    JointVector::from(random_vector(rng, [-3.2; 3], [3.2; 3]))
}

fn rotation(axis: Vector3<f64>, angle: f64) -> Matrix4<f64> {
    Matrix4::from_scaled_axis(axis * angle)
}

/// One row of a Denavit-Hartenberg table (d = 0): Rz(theta) Tx(length) Rx(twist).
fn denavit_hartenberg(theta: f64, length: f64, twist: f64) -> Matrix4<f64> {
    rotation(Vector3::z(), theta)
        * Matrix4::new_translation(&Vector3::new(length, 0.0, 0.0))
        * rotation(Vector3::x(), twist)
}

#[test]
fn pose_agrees_with_the_denavit_hartenberg_chain() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    for _ in 0..POSES {
        let config = random_config(&mut rng);
        let theta = any_theta(&mut rng);
        let [l2, l3, l4] = config.links;
        let chain = Matrix4::new_translation(&Vector3::from(config.base_position))
            * rotation(Vector3::y(), config.phi1_deg.to_radians())
            * rotation(Vector3::x(), config.phi2_deg.to_radians())
            * denavit_hartenberg(theta[0], l2, std::f64::consts::FRAC_PI_2)
            * denavit_hartenberg(theta[1], l3, 0.0)
            * denavit_hartenberg(theta[2], l4, 0.0);

        let geometry = FingerGeometry::new(&config).unwrap();
        let (position, rotation) = fingertip_pose(&geometry, theta);
        // Lengths below 1 m and six rotations, each with an error of a few 1e-16.
        for row in 0..3 {
            assert!((position[row] - chain[(row, 3)]).abs() < 1e-14);
            for column in 0..3 {
                let difference = rotation.col(column)[row] - chain[(row, column)];
                assert!(difference.abs() < 1e-14, "{theta} {difference:e}");
            }
        }
    }
}

#[test]
fn rotation_is_proper_and_its_x_is_the_last_link() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    for _ in 0..POSES {
        let config = random_config(&mut rng);
        let theta = any_theta(&mut rng);
        let (tip, rotation) = fingertip_pose(&FingerGeometry::new(&config).unwrap(), theta);
        let product = rotation * rotation.transpose();
        assert!(product.abs_diff_eq(DMat3::IDENTITY, 1e-14));
        assert!((rotation.determinant() - 1.0).abs() < 1e-14);

        // Joint 3 is at the tip of the same finger with a last link of 1 mm, minus that 1 mm.
        let mut short = config.clone();
        short.links[2] = 1e-3;
        let (near_joint, _) = fingertip_pose(&FingerGeometry::new(&short).unwrap(), theta);
        let link = (tip - near_joint) / (config.links[2] - short.links[2]);
        // Positions with errors of 1e-16 m, divided by a link of at least 19 mm.
        assert!(link.abs_diff_eq(rotation.x_axis, 1e-13));
    }
}

#[test]
fn jacobian_is_the_derivative_of_the_position() {
    // Errors of central differences: h^2/6 |d3r/dtheta3| (third derivatives are below the reach of 0.3 m: 5e-12 m/rad
    // for h = 1e-5 rad) and the rounding of positions (1e-16 m / h = 1e-11).
    const STEP: f64 = 1e-5;
    const BOUND: f64 = 1e-10;
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    for _ in 0..POSES {
        let geometry = random_geometry(&mut rng);
        let theta = any_theta(&mut rng);
        let jacobian = jacobian(&geometry, theta);
        for joint in 0..geometry.joint_count() {
            let mut step = JointVector::zeros(geometry.joint_count());
            step[joint] = STEP;
            let (forward, _) = fingertip_pose(&geometry, theta + step);
            let (backward, _) = fingertip_pose(&geometry, theta - step);
            let column = (forward - backward) / (2.0 * STEP);
            let difference = (column - jacobian.columns()[joint]).abs().max_element();
            assert!(difference < BOUND, "joint {joint} {theta}: {difference:e}");
        }
    }
}

#[test]
fn inverse_kinematics_reaches_every_target_from_every_start() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    for _ in 0..POSES {
        let geometry = random_geometry(&mut rng);
        let (target, _) = fingertip_pose(&geometry, random_theta(&mut rng, &geometry));
        let start = random_theta(&mut rng, &geometry);
        let theta = inverse_kinematics(&geometry, target, start).unwrap();
        let miss = fingertip_pose(&geometry, theta).0.distance(target);
        assert!(miss <= POSITION_TOLERANCE, "{miss:e} m from {target}");
        assert!((theta - geometry.joint_lower()).min_element() >= 0.0);
        assert!((geometry.joint_upper() - theta).min_element() >= 0.0);
    }
}

#[test]
fn inverse_kinematics_starts_and_ends_at_singular_angles() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    for _ in 0..POSES {
        let config = FingerConfig {
            joint_lower_deg: [-170.0, -150.0, -160.0],
            joint_upper_deg: [170.0, 150.0, 160.0],
            ..random_config(&mut rng)
        };
        let geometry = FingerGeometry::new(&config).unwrap();
        let mut straight = random_theta(&mut rng, &geometry);
        straight[2] = 0.0;
        let bent = random_theta(&mut rng, &geometry);
        for (goal, start) in [(straight, bent), (bent, straight)] {
            let (target, _) = fingertip_pose(&geometry, goal);
            let theta = inverse_kinematics(&geometry, target, start).unwrap();
            let miss = fingertip_pose(&geometry, theta).0.distance(target);
            assert!(miss <= POSITION_TOLERANCE, "{miss:e} m from {target}");
        }
    }
}

#[test]
fn inverse_kinematics_keeps_the_nearest_posture() {
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    for _ in 0..POSES {
        let geometry = random_geometry(&mut rng);
        let start = random_theta(&mut rng, &geometry);
        let rate = resolved_rate(&geometry, start, DVec3::ZERO);
        let (lower, upper) = (geometry.joint_lower(), geometry.joint_upper());
        let inside = (start - lower).min(upper - start).min_element() >= 0.05;
        if rate.damping > 0.0 || !inside {
            continue;
        }
        // A tenth of the damping threshold, much less than the distance to a singularity.
        let step = 0.1 * damping_threshold(&geometry);
        let target = fingertip_pose(&geometry, start).0 + DVec3::splat(step / 3.0);
        let Ok(theta) = inverse_kinematics(&geometry, target, start) else {
            panic!("{target} is {step} m from the fingertip");
        };
        // At most 0.1 rad by the bound |J^-1| <= 1 / threshold, and twice that because J changes on the way.
        assert!(theta.distance(start) < 0.2, "from {start} to {theta}");
    }
}

fn cap_finger() -> FingerGeometry {
    FingerGeometry::new(&FingerConfig {
        base_position: [-0.144, 0.0, 0.06],
        phi1_deg: 0.0,
        phi2_deg: 0.0,
        links: [0.025, 0.05, 0.055],
        joint_lower_deg: [-45.0, 0.0, -120.0],
        joint_upper_deg: [45.0, 110.0, -15.0],
        joint_speed_limit: [3.0; 3],
    })
    .unwrap()
}

#[test]
fn out_of_reach_reports_the_distance() {
    let target = DVec3::new(0.1, 0.0, 0.06);
    let error = inverse_kinematics(&cap_finger(), target, JointVector::default()).unwrap_err();
    let KinematicsError::OutOfReach {
        distance,
        minimum,
        maximum,
        ..
    } = error
    else {
        panic!("{error}");
    };
    assert!((distance - (0.244 - 0.025)).abs() < 1e-12);
    assert!((minimum - 0.005).abs() < 1e-12);
    assert!((maximum - 0.105).abs() < 1e-12);
}

#[test]
fn targets_too_near_the_base_are_out_of_reach() {
    // Without l2 the shoulder is on the axis of joint 1, and targets nearer than l4 - l3 are unreachable.
    let geometry = FingerGeometry::new(&FingerConfig {
        base_position: [0.0; 3],
        phi1_deg: 0.0,
        phi2_deg: 0.0,
        links: [0.0, 0.05, 0.055],
        joint_lower_deg: [-180.0; 3],
        joint_upper_deg: [180.0; 3],
        joint_speed_limit: [3.0; 3],
    })
    .unwrap();
    let target = DVec3::new(0.0, 0.003, 0.0);
    let error = inverse_kinematics(&geometry, target, JointVector::default()).unwrap_err();
    let KinematicsError::OutOfReach { distance, .. } = error else {
        panic!("{error}");
    };
    assert!((distance - 0.003).abs() < 1e-12);
}

#[test]
fn beyond_the_joint_limits_reports_the_angles() {
    let geometry = cap_finger();
    let beyond = JointVector::from([60f64.to_radians(), 0.9, -0.9]);
    let (target, _) = fingertip_pose(&geometry, beyond);
    let error =
        inverse_kinematics(&geometry, target, JointVector::from([0.0, 0.9, -0.9])).unwrap_err();
    let KinematicsError::OutsideJointLimits { theta, .. } = error else {
        panic!("{error}");
    };
    assert!(theta.distance(beyond) < 1e-9, "{theta}");
}

#[test]
fn arguments_that_are_not_finite_are_errors() {
    for bad in [f64::NAN, f64::INFINITY] {
        let bad = [0.0, bad, 0.0];
        for (target, start) in [(bad, [0.0; 3]), ([0.0; 3], bad)] {
            let (target, start) = (DVec3::from(target), JointVector::from(start));
            let error = inverse_kinematics(&cap_finger(), target, start).unwrap_err();
            assert!(matches!(error, KinematicsError::NotFinite { .. }));
        }
    }
}

#[test]
fn resolved_rate_is_the_inverse_jacobian_away_from_singularities() {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let mut undamped = 0;
    for _ in 0..POSES {
        let geometry = random_geometry(&mut rng);
        let theta = any_theta(&mut rng);
        let velocity = random_vector(&mut rng, [-0.05; 3], [0.05; 3]);
        let rate = resolved_rate(&geometry, theta, DVec3::from_array(velocity));
        if rate.damping > 0.0 {
            continue;
        }
        undamped += 1;
        let jacobian = jacobian(&geometry, theta);
        let j = Matrix3::from_fn(|row, column| jacobian.columns()[column][row]);
        let expected = j.lu().solve(&Vector3::from(velocity)).unwrap();
        let expected = JointVector::from([expected.x, expected.y, expected.z]);
        // Rounding of 1e-16 times a condition number below 200 (reach 0.3 m over 2 mm), and a factor of 10 for the
        // handful of operations.
        let difference = (rate.joint_velocity - expected).length() / expected.length();
        assert!(difference < 1e-12, "{difference:e}");
    }
    assert!(undamped > POSES / 2, "only {undamped} poses are undamped");
}

#[test]
fn resolved_rate_is_bounded_at_singularities() {
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    for _ in 0..POSES {
        let geometry = random_geometry(&mut rng);
        let mut theta = any_theta(&mut rng);
        theta[2] = rng.random_range(-0.05..0.05) * rng.random_range(0.0..1.0f64).round();
        let velocity = DVec3::from_array(random_vector(&mut rng, [-0.05; 3], [0.05; 3]));
        let rate = resolved_rate(&geometry, theta, velocity);
        assert!(rate.damping > 0.0);
        // The bound in the module's documentation, and rounding.
        let bound = velocity.length() / damping_threshold(&geometry);
        assert!(rate.joint_velocity.length() <= bound * (1.0 + 1e-9));
    }
}

#[test]
fn kinematics_does_not_allocate() {
    let geometry = cap_finger();
    let start = JointVector::from([0.1, 0.9, -1.0]);
    let (target, _) = fingertip_pose(&geometry, JointVector::from([-0.5, 0.2, -2.0]));
    let elbow_up = JointVector::from([0.0, 0.2, 1.0]);
    let far = DVec3::splat(1.0);
    assert_no_alloc(|| {
        let straight = JointVector::from([0.1, 0.9, 0.0]);
        std::hint::black_box(resolved_rate(&geometry, start, DVec3::X));
        std::hint::black_box(resolved_rate(&geometry, straight, DVec3::X));
        assert!(inverse_kinematics(&geometry, target, start).is_ok());
        assert!(inverse_kinematics(&geometry, target, elbow_up).is_ok());
        assert!(inverse_kinematics(&geometry, far, start).is_err());
    });
}

proptest! {
    #[test]
    fn finite_arguments_give_finite_results(
        theta in prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::ZERO),
        velocity in prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL),
        straight in any::<bool>(),
    ) {
        let geometry = cap_finger();
        let [theta1, theta2, theta3] = theta;
        let theta3 = if straight { 0.0 } else { theta3 };
        let theta = JointVector::from([theta1, theta2, theta3]);
        let (position, rotation) = fingertip_pose(&geometry, theta);
        prop_assert!(position.is_finite() && rotation.is_finite());
        let jacobian = jacobian(&geometry, theta);
        prop_assert!(jacobian.columns().iter().all(|column| column.is_finite()));
        let rate = resolved_rate(&geometry, theta, DVec3::from_array(velocity));
        prop_assert!(rate.joint_velocity.is_finite() && rate.damping.is_finite());
    }

    #[test]
    fn inverse_kinematics_of_anything_finite_is_a_solution_or_an_error(
        target in prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::ZERO),
        start in prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::ZERO),
        scale in prop::array::uniform3(-0.12..0.12f64),
        near in any::<bool>(),
    ) {
        let geometry = cap_finger();
        let target = if near {
            DVec3::from_array([-0.144, 0.0, 0.06]) + DVec3::from_array(scale)
        } else {
            DVec3::from_array(target)
        };
        if let Ok(theta) = inverse_kinematics(&geometry, target, JointVector::from(start)) {
            let miss = fingertip_pose(&geometry, theta).0.distance(target);
            prop_assert!(miss <= POSITION_TOLERANCE);
        }
    }
}
