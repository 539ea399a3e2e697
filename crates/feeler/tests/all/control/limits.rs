//! Motion limits, which all commands pass: each limit alone and over whole motions.

use super::rig::{control, geometry, home};
use feeler::control::{LimitedCommand, LimitsConfig, Request};
use feeler::hand::kinematics::{fingertip_pose, jacobian};
use feeler::hand::{FingerGeometry, JointVector};
use glam::DVec3;

const PERIOD: f64 = 0.01;

struct Finger {
    limits: LimitsConfig,
    geometry: FingerGeometry,
    theta: JointVector,
    previous: JointVector,
}

impl Finger {
    fn at_home() -> Self {
        Self {
            limits: control().limits,
            geometry: geometry(),
            theta: home(),
            previous: JointVector::default(),
        }
    }

    fn position(&self) -> DVec3 {
        fingertip_pose(&self.geometry, self.theta).0
    }

    /// Fingertip velocity (m/s) at these joint velocities (rad/s).
    fn moved_at(&self, joint_velocity: JointVector) -> DVec3 {
        jacobian(&self.geometry, self.theta) * joint_velocity
    }

    fn apply_limits(&self, velocity: DVec3) -> Option<LimitedCommand> {
        let request = Request {
            velocity,
            position: self.position(),
            theta: self.theta,
            previous: self.previous,
        };
        self.limits.apply_limits(&self.geometry, &request, PERIOD)
    }

    /// Moves for a period like an ideal drive.
    fn advance(&mut self, velocity: DVec3) -> LimitedCommand {
        let admitted = self.apply_limits(velocity).expect("finite");
        self.theta += PERIOD * admitted.joint_velocity;
        self.previous = admitted.joint_velocity;
        admitted
    }
}

#[test]
fn a_velocity_within_all_limits_is_unchanged() {
    let finger = Finger::at_home();
    let velocity = DVec3::new(0.002, -0.0015, 0.001);
    let admitted = finger.apply_limits(velocity).expect("finite");
    assert!(!admitted.limited, "{admitted:?}");
    let back = finger.moved_at(admitted.joint_velocity);
    assert!((back - velocity).length() < 1e-15);
}

#[test]
fn non_finite_velocities_are_rejected() {
    let finger = Finger::at_home();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(finger.apply_limits(DVec3::new(0.0, bad, 0.0)), None);
    }
    let bad = Finger {
        theta: JointVector::splat(3, f64::NAN),
        ..Finger::at_home()
    };
    assert_eq!(bad.apply_limits(DVec3::ZERO), None);
    let bad = Finger {
        previous: JointVector::splat(3, f64::INFINITY),
        ..Finger::at_home()
    };
    assert_eq!(bad.apply_limits(DVec3::ZERO), None);
}

#[test]
fn the_fingertip_speed_limit_preserves_the_direction() {
    let mut finger = Finger::at_home();
    finger.limits.joint_acceleration = 1e6;
    let wanted = DVec3::new(0.3, 0.0, -0.4);
    let admitted = finger.apply_limits(wanted).expect("finite");
    let actual = finger.moved_at(admitted.joint_velocity);
    // 50 mm/s along (0.6, 0, -0.8).
    assert!(
        (actual - DVec3::new(0.03, 0.0, -0.04)).length() < 1e-15,
        "{actual}"
    );
    assert!(admitted.limited);
}

#[test]
fn joint_speed_limits_preserve_the_direction() {
    let mut finger = Finger::at_home();
    finger.limits.fingertip_speed = 10.0;
    finger.limits.joint_acceleration = 1e6;
    let wanted = DVec3::new(0.0, 0.5, 0.1);
    let admitted = finger.apply_limits(wanted).expect("finite");
    let speed = admitted.joint_velocity.abs();
    let limit = finger.geometry.joint_speed_limit();
    assert!((speed / limit).max_element() <= 1.0 + 1e-15);
    assert!((speed / limit).max_element() > 1.0 - 1e-15);
    let actual = finger.moved_at(admitted.joint_velocity);
    assert!(actual.cross(wanted).length() < 1e-15, "{actual}");
}

#[test]
fn joint_acceleration_is_limited() {
    let mut finger = Finger::at_home();
    finger.limits.fingertip_speed = 10.0;
    // 20 rad/s^2 for 10 ms.
    let most = 0.2;
    for n in 0..60 {
        let sign = if (n / 7) % 2 == 0 { 1.0 } else { -1.0 };
        let before = finger.previous;
        let admitted = finger.advance(sign * DVec3::new(0.2, 0.3, -0.1));
        let change = (admitted.joint_velocity - before).abs().max_element();
        assert!(change <= most + 1e-15, "{change} rad/s");
    }
}

#[test]
fn no_joint_passes_its_limit_at_any_speed() {
    for direction in [
        DVec3::Y,
        -DVec3::Y,
        DVec3::X,
        -DVec3::X,
        DVec3::Z,
        DVec3::new(1.0, 1.0, -1.0),
    ] {
        let mut finger = Finger::at_home();
        finger.limits.workspace_lower = [-10.0; 3];
        finger.limits.workspace_upper = [10.0; 3];
        finger.limits.fingertip_speed = 10.0;
        let (lower, upper) = (finger.geometry.joint_lower(), finger.geometry.joint_upper());
        let mut nearest = f64::INFINITY;
        for _ in 0..2000 {
            finger.advance(0.3 * direction);
            let room = (finger.theta - lower)
                .min(upper - finger.theta)
                .min_element();
            // Rounding of angles of about 1 rad.
            assert!(
                room >= -1e-15,
                "{room} rad left when moving along {direction}"
            );
            nearest = nearest.min(room);
        }
        assert!(
            nearest < 1e-6,
            "{nearest} rad: the limit was never approached"
        );
    }
}

#[test]
fn no_fingertip_leaves_its_workspace_at_any_speed() {
    let directions = [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .flat_map(|d| [d, -d]);
    for direction in directions.chain([DVec3::new(1.0, -1.0, 1.0), DVec3::new(-1.0, 1.0, -1.0)]) {
        let mut finger = Finger::at_home();
        let lower = DVec3::from(finger.limits.workspace_lower);
        let upper = DVec3::from(finger.limits.workspace_upper);
        let mut nearest = f64::INFINITY;
        for _ in 0..1000 {
            if finger.advance(direction).damping > 0.0 {
                // Almost straight: the finger's reach ends before the workspace does.
                nearest = 0.0;
                break;
            }
            let room = (finger.position() - lower).min(upper - finger.position());
            // Joint velocities are exact at the period's start. Moving 0.5 mm in a period along an arc with the
            // shortest link, 55 mm, deviates by 0.5^2 / (2 * 55) mm.
            assert!(
                room.min_element() >= -2.3e-6,
                "{room} m left when moving along {direction}"
            );
            nearest = nearest.min(room.min_element());
        }
        assert!(
            nearest < 1e-5,
            "{nearest} m: the boundary was never approached"
        );
    }
}

#[test]
fn fingers_outside_the_limits_may_return() {
    let mut finger = Finger::at_home();
    finger.limits.workspace_lower = [-0.030, -0.03, 0.07];
    let out = finger.advance(DVec3::NEG_X * 0.01);
    assert!(out.limited && out.joint_velocity == JointVector::default());
    for _ in 0..1000 {
        finger.advance(DVec3::X * 0.02);
    }
    assert!(finger.position().x > -0.030);
}
