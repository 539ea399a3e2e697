//! A free box, pushed and squeezed by feelers.

use super::scene::{GRAVITY, cuboid, empty, fixed, free, world_with_fingers};
use feeler_sim::objects::Pose;
use feeler_sim::shapes::shape::ShapeConfig;
use feeler_sim::world::{SimConfig, World};
use glam::{DMat3, DVec3};

const MASS: f64 = 0.05;
const SIDE: f64 = 0.03;
/// Distance from the dome's centre to the outside of its undeformed tips (m).
const REACH: f64 = 0.018 + 0.0015;

/// A free box at the origin, without gravity.
fn floating(damping: f64) -> SimConfig {
    let mut sim = empty();
    sim.gravity = [0.0; 3];
    (sim.feeler.normal_damping, sim.feeler.shear_damping) = (damping, damping);
    let body = free(cuboid(SIDE, SIDE, SIDE), MASS, 0.5);
    sim.object.insert("box".into(), body);
    sim
}

/// Pose of a fingertip whose dome points along `direction` and ends `gap` (m) before the plane through the origin
/// across that direction, displaced by `aside` (m).
fn facing(direction: DVec3, gap: f64, aside: DVec3) -> Pose {
    let helper = if direction.x.abs() < 0.9 {
        DVec3::X
    } else {
        DVec3::Y
    };
    let side = direction.cross(helper).normalize();
    // The dome's axis is the fingertip's x.
    Pose {
        position: -(REACH + gap) * direction + aside,
        rotation: DMat3::from_cols(direction, side, direction.cross(side)),
    }
}

fn held(sim: &SimConfig, poses: &[Pose]) -> World {
    let mut world = world_with_fingers(sim, poses.len());
    for (finger, &pose) in poses.iter().enumerate() {
        world.hold_fingertip(finger, Some(pose));
    }
    world
}

#[test]
fn a_pushed_boxs_momentum_equals_the_feelers_impulse() {
    // The object's origin may differ from its centre of mass.
    for offset in [DVec3::ZERO, DVec3::new(0.006, -0.005, 0.008)] {
        pushed_box_gains_momentum(offset);
    }
}

/// Pushes a box centred at the origin whose frame is displaced from its centre by `-offset` (m).
fn pushed_box_gains_momentum(offset: DVec3) {
    let mut sim = floating(0.0);
    let body = sim.object.get_mut("box").expect("the box");
    (body.position, body.offset) = ((-offset).to_array(), offset.to_array());
    let at = |time: f64| {
        facing(
            DVec3::X,
            SIDE / 2.0 + 0.0005 - 0.02 * time,
            DVec3::new(0.0, 0.004, 0.002),
        )
    };
    let mut world = held(&sim, &[at(0.0)]);
    let (mut impulse, mut angular_impulse) = (DVec3::ZERO, DVec3::ZERO);
    for n in 1..=400 {
        world.hold_fingertip(0, Some(at(sim.step * f64::from(n))));
        let centre = world.state().objects[0].pose.rotation * offset;
        world.step().expect("a step");
        let (force, torque) = world.wrench(0);
        impulse += sim.step * force;
        angular_impulse += sim.step * (torque - centre.cross(force));
    }
    let body = &world.state().objects[0];
    let momentum = MASS * body.velocity;
    assert!(impulse.length() > 1e-3, "{impulse} N s");
    // Rounding errors of 400 steps.
    let error = (momentum - impulse).length();
    assert!(error < 1e-15, "{error} N s of {impulse}");
    let spin = MASS * SIDE * SIDE / 6.0 * body.angular_velocity;
    assert!(angular_impulse.length() > 1e-6, "{angular_impulse} N m s");
    // The levers are evaluated after the body has turned by up to another 0.5 mrad, and the torques are small
    // differences of large terms.
    let error = (spin - angular_impulse).length() / angular_impulse.length();
    assert!(error < 0.005, "{error} of {angular_impulse} N m s");
}

/// A box squeezed by two fingers on its table and lifted off it by 10 mm in 1 s; `damping` in N·s/m.
fn lifted(damping: f64) -> World {
    let mut sim = floating(damping);
    sim.gravity = [0.0, 0.0, -GRAVITY];
    let mut table = fixed(ShapeConfig::HalfSpace);
    table.position = [0.0, 0.0, -SIDE / 2.0];
    sim.object.insert("table".into(), table);
    let fingers = |depth: f64, height: f64| {
        [DVec3::X, DVec3::NEG_X]
            .map(|direction| facing(direction, SIDE / 2.0 - depth, height * DVec3::Z))
    };
    let mut world = held(&sim, &fingers(-0.001, 0.0));
    let squeeze = (1..=1000).map(|n| (-0.001 + 3e-6 * f64::from(n), 0.0));
    let lift = (1..=1500).map(|n| (0.002, 1e-5 * f64::from(n.min(1000))));
    for (depth, height) in squeeze.chain(lift) {
        for (finger, pose) in fingers(depth, height).into_iter().enumerate() {
            world.hold_fingertip(finger, Some(pose));
        }
        world.step().expect("a step");
    }
    world
}

#[test]
fn a_squeezed_box_hangs_between_two_fingers_for_a_minute_without_creep() {
    let mut world = lifted(0.5);
    let index = world.model().object("box").expect("the box");
    let start = world.state().objects[index].pose;
    // The box hangs on the feelers' shear springs and therefore rises less than the fingers' 10 mm.
    assert!(
        (0.0095..0.010).contains(&start.position.z),
        "{}",
        start.position
    );
    for _ in 0..60_000 {
        world.step().expect("a step");
    }
    let end = world.state().objects[index].pose;
    // Only rounding errors.
    assert!(end.position.distance(start.position) < 1e-12);
    assert!((end.rotation.z_axis - start.rotation.z_axis).length() < 1e-12);
    let (force, _) = world.wrench(index);
    assert!(
        (force - MASS * GRAVITY * DVec3::Z).length() < 1e-9,
        "{force} N"
    );
}

#[test]
fn a_light_body_between_stiff_feelers_is_stable_at_any_step_size() {
    // A tenth of the mass of the lightest box of the tasks, without damping: explicit integration at 1 ms would be
    // unstable with the springs of two fingers.
    for step in [0.001, 0.0005, 0.002] {
        let mut sim = floating(0.0);
        sim.step = step;
        let body = free(cuboid(SIDE, SIDE, SIDE), 0.003, 0.5);
        sim.object.insert("box".into(), body);
        let fingers = |depth: f64| {
            [DVec3::X, DVec3::NEG_X]
                .map(|direction| facing(direction, SIDE / 2.0 - depth, DVec3::ZERO))
        };
        let mut world = held(&sim, &fingers(-0.0005));
        for n in 1..=4000 {
            let depth = (-0.0005 + 0.002 * step * f64::from(n)).min(0.002);
            for (finger, pose) in fingers(depth).into_iter().enumerate() {
                world.hold_fingertip(finger, Some(pose));
            }
            world.step().expect("a step");
            let body = &world.state().objects[0];
            // Less than the compression of the squeeze.
            let off = body.pose.position.length();
            assert!(off < 0.0005, "{off} m off at step {n} of {step} s");
        }
    }
}
