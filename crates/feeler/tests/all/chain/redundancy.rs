//! Self-motion and joint limits of fingers with more joints than their task needs.

use super::{Joints, fingertip_velocity, planar, random_joints, reference_chain, reference_chains};
use feeler::hand::chain::{Chain, MAX_JOINTS};
use glam::DVec3;
use nalgebra::{DVector, Matrix3xX};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

#[test]
fn a_finger_at_rest_stays_at_rest() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    for chain in reference_chains() {
        for _ in 0..100 {
            let joints = random_joints(&mut rng, &chain);
            let rate = chain.resolved_rate(&joints, DVec3::ZERO);
            assert_eq!(rate.joint_velocity, [0.0; MAX_JOINTS]);
        }
    }
}

/// Deviation from the middle of the joints' ranges, relative to half of the ranges: sum of squares.
fn deviation(chain: &Chain, joints: &Joints) -> f64 {
    let (lower, upper) = (chain.joint_lower(), chain.joint_upper());
    let relative = |j: usize| (2.0 * joints[j] - lower[j] - upper[j]) / (upper[j] - lower[j]);
    (0..chain.joint_count()).map(|j| relative(j).powi(2)).sum()
}

/// Pseudo-inverse without self-motion.
fn least_norm(chain: &Chain, joints: &Joints, velocity: DVec3) -> Joints {
    let columns = chain.jacobian(joints);
    let columns = columns.iter().take(chain.joint_count());
    let columns: Vec<_> = columns
        .map(|c| nalgebra::Vector3::from(c.to_array()))
        .collect();
    let inverse = Matrix3xX::from_columns(&columns)
        .pseudo_inverse(1e-9)
        .unwrap();
    let rate: DVector<f64> = inverse * nalgebra::Vector3::from(velocity.to_array());
    let mut rates = [0.0; MAX_JOINTS];
    rates
        .iter_mut()
        .zip(rate.iter())
        .for_each(|(to, from)| *to = *from);
    rates
}

/// Velocities at which no joint leaves its limits within a period of 10 ms.
fn bounds(chain: &Chain, joints: &Joints) -> [[f64; 2]; MAX_JOINTS] {
    let (lower, upper) = (chain.joint_lower(), chain.joint_upper());
    std::array::from_fn(|j| [lower[j] - joints[j], upper[j] - joints[j]].map(|room| room / 0.01))
}

/// Drives the fingertip ten times around a circle of 8 mm at 100 Hz with feedback of the position.
/// Returns the final deviation, the largest distance from the circle (m), and `true` if the joints kept their limits.
fn circles(
    chain: &Chain,
    start: Joints,
    rate: impl Fn(&Joints, DVec3) -> Joints,
) -> (f64, f64, bool) {
    let mut joints = start;
    let (centre, rotation) = chain.pose(&joints);
    let at = |angle: f64| {
        let offset = rotation.y_axis * angle.sin() + rotation.z_axis * (angle.cos() - 1.0);
        centre + offset * 0.008
    };
    let (mut miss, mut kept) = (0.0_f64, true);
    for step in 1..=4000 {
        let angle = f64::from(step) * std::f64::consts::TAU / 400.0;
        let error = at(angle) - chain.pose(&joints).0;
        let velocity = rate(&joints, error / 0.01);
        for (q, v) in joints.iter_mut().zip(velocity) {
            *q += v * 0.01;
        }
        let (lower, upper) = (chain.joint_lower(), chain.joint_upper());
        for joint in 0..chain.joint_count() {
            let clamped = joints[joint].clamp(lower[joint], upper[joint]);
            // Rounding of angles of a few radians.
            kept &= (joints[joint] - clamped).abs() < 1e-15;
            joints[joint] = clamped;
        }
        miss = miss.max((at(angle) - chain.pose(&joints).0).length());
    }
    (deviation(chain, &joints), miss, kept)
}

#[test]
fn circles_end_nearer_to_the_middle_of_the_ranges() {
    for (name, start) in [
        ("leap", [0.05, 0.43, 1.29, 0.43, 0.0, 0.0, 0.0]),
        ("allegro", [-0.13, 0.0, 1.46, 0.07, 0.0, 0.0, 0.0]),
        ("skewed", [-0.78, 0.11, 0.03, -0.04, -0.57, -0.12, 1.34]),
    ] {
        let chain = reference_chain(name);
        let own = |joints: &Joints, v| {
            let bounds = bounds(&chain, joints);
            chain
                .resolved_rate_within(joints, v, &bounds)
                .joint_velocity
        };
        let (with, miss, kept) = circles(&chain, start, own);
        let (without, ..) = circles(&chain, start, |joints, v| least_norm(&chain, joints, v));
        println!(
            "{name}: deviation {with:.3} with self-motion, {without:.3} without; {miss:e} m off"
        );
        assert!(kept, "{name} left its limits");
        // A step moves the fingertip by 0.13 mm; the curvature of its path over a step is below 1 / (10 mm).
        assert!(miss < 1e-5, "{name}: {miss} m off the circle");
        assert!(with < 0.9 * without, "{name}: {with} {without}");
    }
}

/// A joint at its limit stops, and the others do the task.
#[test]
fn other_joints_replace_one_at_its_limit() {
    let chain = Chain::new(&planar(4)).unwrap();
    let mut joints = [0.7, 0.8, 0.6, 2.0, 0.0, 0.0, 0.0];
    let velocity = DVec3::new(0.05, -0.03, 0.0);
    let outward = chain.resolved_rate(&joints, velocity);
    let inward = chain.resolved_rate(&joints, -velocity);
    let fixed = [outward, inward].map(|rate| rate.bounded[3]);
    assert_ne!(
        fixed[0], fixed[1],
        "one direction moves the last joint outward"
    );
    for (rate, velocity) in [(outward, velocity), (inward, -velocity)] {
        assert!(rate.joint_velocity[3] <= 0.0);
        let moved = fingertip_velocity(&chain, &joints, &rate.joint_velocity);
        // Velocities below 0.1 m/s.
        assert!(moved.abs_diff_eq(velocity, 1e-14), "{moved}");
    }
    // With all joints at a limit, none moves outward.
    joints[..4].fill(2.0);
    for angle in 0..100 {
        let direction = DVec3::X.rotate_axis(DVec3::Z, f64::from(angle) * 0.063);
        let rate = chain.resolved_rate(&joints, direction);
        assert!(rate.joint_velocity.iter().all(|&v| v <= 0.0), "{rate:?}");
    }
}

/// A joint that is bounded keeps its bound, and the others move the fingertip as requested.
#[test]
fn bounded_joints_are_replaced_by_others() {
    let mut rng = Pcg64Mcg::seed_from_u64(9);
    let chain = Chain::new(&planar(5)).unwrap();
    let (mut bounded, mut met) = (0, 0);
    for _ in 0..500 {
        let joints = random_joints(&mut rng, &chain);
        let velocity = DVec3::new(0.03, -0.02, 0.0);
        let free = chain.resolved_rate(&joints, velocity);
        let limit = 0.9
            * free
                .joint_velocity
                .iter()
                .fold(0.0_f64, |most, v| most.max(v.abs()));
        let rate = chain.resolved_rate_within(&joints, velocity, &[[-limit, limit]; MAX_JOINTS]);
        // One product and quotient.
        let most = limit * (1.0 + 1e-15);
        assert!(rate.joint_velocity.iter().all(|v| v.abs() <= most));
        bounded += usize::from(rate.bounded.contains(&true));
        let moved = fingertip_velocity(&chain, &joints, &rate.joint_velocity);
        met += usize::from(rate.damping == 0.0 && moved.abs_diff_eq(velocity, 1e-12));
    }
    assert_eq!(bounded, 500);
    // Other joints cannot always take over, and some positions are near singularities.
    assert!(met > 350, "{met}");
}

/// The joint velocity is a continuous function of the bounds: a joint that reaches its bound does not change the others.
#[test]
fn joint_velocity_is_continuous_where_a_bound_is_reached() {
    let chain = reference_chain("allegro");
    let joints = [0.2, 0.5, 0.9, 0.7, 0.0, 0.0, 0.0];
    let velocity = DVec3::new(0.05, -0.02, 0.04);
    let free = chain.resolved_rate(&joints, velocity);
    for joint in 0..4 {
        let at = |share: f64| {
            let limit = share * free.joint_velocity[joint].abs();
            let mut bounds = [[f64::NEG_INFINITY, f64::INFINITY]; MAX_JOINTS];
            bounds[joint] = [-limit, limit];
            chain.resolved_rate_within(&joints, velocity, &bounds)
        };
        let (outside, inside) = (at(1.0 + 1e-9), at(1.0 - 1e-9));
        assert!(!outside.bounded[joint] && inside.bounded[joint]);
        let pairs = outside
            .joint_velocity
            .into_iter()
            .zip(inside.joint_velocity);
        let jump = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        // Joint velocities below 10 rad/s change by a share of 2e-9, times the condition number, below 30.
        assert!(jump < 1e-6, "joint {joint}: {jump:e} rad/s");
    }
}
