//! The outline that the contour task measures on a plane surface, with forces that follow Coulomb's law.

use super::rig::layout;
use feeler::control::task::Task;
use feeler::control::task::contour::{Contour, ContourConfig};
use feeler::control::{FeelerShape, FingertipPose, HandReadings, Phase, TactileReading};
use feeler::hand::JointState;
use glam::{DMat3, DVec2, DVec3};

const CONTACT_FORCE: f64 = 1.0;
const PERIOD: f64 = 0.01;

fn config() -> ContourConfig {
    ContourConfig {
        home: [0.05, 0.0, 0.1],
        approach: [-1.0, 0.0, 0.0],
        search_speed: 0.01,
        search_limit: 0.05,
        follow_speed: 0.01,
        contact_force: CONTACT_FORCE,
        touch_force: 0.05,
        force_gain: 0.01,
        press_speed: 0.01,
        friction_gain: 5.0,
        closing_distance: 0.001,
        lost_time: 0.5,
        follow_limit: 60.0,
        clearance: 0.005,
        return_speed: 0.02,
        home_tolerance: 0.001,
        feeler: FeelerShape {
            normal_stiffness: 200.0,
            shear_stiffness: 100.0,
            tip_radius: 0.002,
        },
    }
}

/// Pose and reading of a fingertip whose apex touches a surface at `point` with the outward `normal` (both in the
/// plane) and is pushed by `force` (N, in W).
fn pressed(point: DVec2, normal: DVec2, force: DVec2) -> (FingertipPose, TactileReading) {
    let FeelerShape {
        normal_stiffness,
        shear_stiffness,
        tip_radius,
    } = config().feeler;
    // The dome faces the surface at a small angle.
    let axis = DVec2::from_angle(0.2).rotate(-normal).extend(0.0);
    let rotation = DMat3::from_cols(axis, DVec3::Z.cross(axis), DVec3::Z);
    let force = force.extend(0.0);
    let along = force.dot(axis) * axis;
    let bent = along / normal_stiffness + (force - along) / shear_stiffness;
    let tip = (point + tip_radius * normal).extend(0.1);
    let pose = FingertipPose {
        position: tip - layout().dome_radius * axis - bent,
        rotation,
    };
    let element = layout().elements[0].rotation;
    let own = element.transpose() * (rotation.transpose() * force);
    let mut touch = TactileReading::none(layout().elements.len());
    touch.frame.forces[0] = own.with_z(-own.z);
    (pose, touch)
}

#[test]
fn outline_points_lie_on_the_surface_once_friction_is_learned() {
    for angle in [0.0, 0.3, -0.5] {
        let normal = DVec2::from_angle(angle);
        for friction in [0.0_f64, 0.2, 0.8] {
            let lean = friction.atan();
            let mut task = Contour::new(&config());
            let mut step = 0;
            let mut advance = |task: &mut Contour, point, force| {
                let (pose, touch) = pressed(point, normal, force);
                let hand = HandReadings {
                    stamp: PERIOD * f64::from(step),
                    poses: &[pose],
                    joints: &[JointState::default()],
                    touches: &[touch],
                    layouts: &[layout()],
                    closed: &[],
                };
                step += 1;
                task.advance(&hand).expect("no reason to stop");
            };
            advance(&mut task, DVec2::ZERO, CONTACT_FORCE * normal);
            assert_eq!(task.phase(), Phase::Move);
            // The surface is on the finger's left as it moves. Friction on the feeler points backwards, to the right
            // of the normal, so the force leans by the friction angle.
            let direction = DVec2::from_angle(-lean).rotate(normal);
            // The force is too weak until the angle is learned, by a little in each step; then it is the target
            // force.
            let mut learned = 0.0;
            while learned < lean {
                let rate = 5.0 * PERIOD;
                let missing = (lean - learned).min(0.4 * rate) / rate;
                let magnitude = (CONTACT_FORCE - missing) / f64::cos(learned);
                advance(&mut task, DVec2::ZERO, magnitude * direction);
                learned += rate * missing;
                if lean - learned < 1e-12 {
                    break;
                }
            }
            for along in [0.0, 0.001, 0.002] {
                let point = DVec2::new(0.02, -0.01) + along * normal.perp();
                advance(&mut task, point, CONTACT_FORCE / f64::cos(lean) * direction);
                let found: Vec<f64> = task.findings().iter().map(|f| f.value).collect();
                let error = point.distance(DVec2::new(found[0], found[1]));
                // Rounding of lengths up to 0.1 m and of an angle that is a sum of up to forty terms.
                assert!(error < 1e-12, "error of {error} m with friction {friction}");
                assert!((found[5] - friction).abs() < 1e-9, "{found:?}");
            }
        }
    }
}
