//! Time per call of the kinematics functions.

use divan::{Bencher, black_box};
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
