//! A fingertip with a single element on a fixed cap: the contact law within a complete world.

use crate::rig;
use feeler::hand::{FingerConfig, FingerGeometry, JointVector, resolved_rate};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig, RingConfig};
use feeler_sim::objects::MotionConfig;
use feeler_sim::shapes::shape::ShapeConfig;
use feeler_sim::world::World;
use glam::DVec3;
use std::path::Path;

const STEP: f64 = 0.001;
const SPEED: f64 = 0.010;
const DEPTH: f64 = 0.0005;
const LINK: f64 = 1.0;
const CAP_RADIUS: f64 = 0.05;

/// A finger in front of a cap that cannot turn.
///
/// Its links are 1 m long, so that it hardly tilts within a millimetre. Its only feeler points along x at the cap's
/// axis and just touches the cap.
fn one_element() -> World {
    let mut sim = rig::sim();
    sim.step = STEP;
    sim.servo.lag = 0.0;
    sim.variation.bottle_position = 0.0;
    sim.variation.friction = 0.0;
    let cap = sim.object.get_mut("cap").expect("a cap");
    cap.motion = MotionConfig::Fixed;
    cap.shape = ShapeConfig::Cylinder {
        radius: CAP_RADIUS,
        height: 0.2,
    };
    cap.position = [0.0; 3];
    let layout = ElementLayout::new(&LayoutConfig {
        dome_radius: 0.018,
        rings: vec![RingConfig {
            elements: 1,
            polar_angle_deg: 0.0,
        }],
        grid: None,
    });
    // theta2 = 60 deg, theta3 = -60 deg: the last link is horizontal.
    let theta = DVec3::new(0.0, 60.0, -60.0) * 1_f64.to_radians();
    let reach = DVec3::new(LINK * (2.0 + theta.y.cos()), 0.0, LINK * theta.y.sin());
    let centre = DVec3::NEG_X * (CAP_RADIUS + sim.feeler.tip_radius + layout.dome_radius);
    let finger = FingerGeometry::new(&FingerConfig {
        base_position: (centre - reach).to_array(),
        phi1_deg: 0.0,
        phi2_deg: 0.0,
        links: [LINK; 3],
        joint_lower_deg: [-180.0; 3],
        joint_upper_deg: [180.0; 3],
        joint_speed_limit: [10.0; 3],
    });
    let fingers = [(finger.expect("a finger"), layout)];
    World::new(&sim, &fingers, &[theta.to_array().into()], Path::new(""), 0).expect("a world")
}

/// Centre of the undeformed tip (m, in W).
fn tip(world: &World) -> DVec3 {
    let tip = &world.state().fingers[0].tip;
    tip.position + world.model().fingers[0].dome_radius * tip.rotation.x_axis
}

/// Moves the undeformed tip to `target` in one step.
fn move_tip(world: &mut World, target: DVec3) {
    let offset = world.model().fingers[0].dome_radius * DVec3::X;
    let finger = &world.state().fingers[0];
    let velocity = (target - offset - finger.tip.position) / STEP;
    let geometry = &world.model().fingers[0].geometry;
    let rate = resolved_rate(geometry, finger.joints.position, velocity);
    world.command(0, rate.joint_velocity);
    world.step().expect("a step");
}

fn force(world: &World) -> DVec3 {
    world.state().fingers[0].forces[0]
}

/// Relative tolerance of the shear force: twice its deviation from K times the displacement d while the finger tilts by
/// d / l4, which is (k_n - k_t) depth d / l4, or 1.5 * 0.5 mm / 1 m of the shear force.
const TILT: f64 = 1.5e-3;

#[test]
fn the_force_on_a_dragged_element_follows_stiffness_and_then_friction() {
    let mut world = one_element();
    let start = tip(&world);
    for n in 1..=10 {
        move_tip(&mut world, start + DVec3::X * (DEPTH * f64::from(n) / 10.0));
    }
    let feeler = world.model().fingers[0].feelers[0].clone();
    let normal_force = feeler.normal_stiffness * DEPTH;
    let pressed = force(&world);
    // While approaching, the finger and its tip tilt by at most the depth divided by the link's length.
    let tilt = DEPTH / LINK;
    let aside =
        (feeler.shear_stiffness * world.model().fingers[0].dome_radius + normal_force) * tilt;
    assert!(
        (pressed - normal_force * DVec3::X).length() < aside,
        "{pressed}"
    );

    let origin = tip(&world);
    let (mut slips, mut before) = (Vec::new(), 0.0);
    for n in 1..=300 {
        let x = origin + DVec3::Z * (SPEED * STEP * f64::from(n));
        move_tip(&mut world, x);
        let shear = force(&world).z;
        if shear < before {
            slips.push(STEP * f64::from(n));
            let kinetic = feeler.kinetic_friction * force(&world).x;
            // Plus the shear force that builds up in one step.
            let step = feeler.shear_stiffness * SPEED * STEP;
            let above = shear - kinetic;
            assert!(
                (-TILT * kinetic..1.1 * step).contains(&above),
                "{shear} N after a slip"
            );
        } else if slips.is_empty() {
            let expected = feeler.shear_stiffness * (tip(&world) - origin).z;
            let tolerance = TILT * expected + aside;
            assert!(
                (shear - expected).abs() < tolerance,
                "{shear} N, not {expected}"
            );
        }
        before = shear;
    }
    let rate = feeler.shear_stiffness * SPEED;
    let first = feeler.static_friction * normal_force / rate;
    let period = (feeler.static_friction - feeler.kinetic_friction) * normal_force / rate;
    // At most one step late; the dome's radius times the tilt makes the tip 2 % faster than commanded.
    assert!(
        (slips[0] - first).abs() < STEP + 0.02 * first,
        "{} s",
        slips[0]
    );
    assert!(slips.len() > 3);
    for pair in slips.windows(2) {
        let actual = pair[1] - pair[0];
        assert!((actual - period).abs() < STEP + 0.02 * period, "{actual} s");
    }
}

#[test]
fn an_element_at_rest_holds_its_shear_for_ten_seconds() {
    let mut world = one_element();
    let start = tip(&world);
    for n in 1..=10 {
        move_tip(&mut world, start + DVec3::X * (DEPTH * f64::from(n) / 10.0));
    }
    let origin = tip(&world);
    for n in 1..=100 {
        move_tip(
            &mut world,
            origin + DVec3::Z * (SPEED * STEP * f64::from(n)),
        );
    }
    world.command(0, JointVector::default());
    world.step().expect("a step");
    let held = force(&world);
    assert!(held.z > 0.4, "{held}");
    for _ in 0..10_000 {
        world.step().expect("a step");
        // Nothing moves, so the force stays bit-identical.
        assert_eq!(force(&world), held);
    }
}

#[test]
fn each_slip_dissipates_the_spring_energy_between_static_and_kinetic_limit() {
    let mut world = one_element();
    let start = tip(&world);
    for n in 1..=10 {
        move_tip(&mut world, start + DVec3::X * (DEPTH * f64::from(n) / 10.0));
    }
    let lost = |world: &World| {
        (
            world.state().fingers[0].slipped[0],
            world.state().slip_work(),
        )
    };
    let before = lost(&world);
    let origin = tip(&world);
    let (mut slips, mut shear) = (0.0, 0.0);
    for n in 1..=400 {
        move_tip(
            &mut world,
            origin + DVec3::Z * (SPEED * STEP * f64::from(n)),
        );
        let now = force(&world).z;
        slips += f64::from(u8::from(now < shear));
        shear = now;
    }
    assert!(slips >= 4.0, "{slips}");
    let feeler = &world.model().fingers[0].feelers[0];
    let normal_force = feeler.normal_stiffness * DEPTH;
    let limits = [feeler.static_friction, feeler.kinetic_friction].map(|mu| mu * normal_force);
    let way = slips * (limits[0] - limits[1]) / feeler.shear_stiffness;
    let work = slips * (limits[0].powi(2) - limits[1].powi(2)) / (2.0 * feeler.shear_stiffness);
    let after = lost(&world);
    // The finger tilts by 4 mm over its link while it drags, which turns some of the shear into normal force: up to
    // (k_n - k_t) / k_n of it, 0.7 %. Work is proportional to the square of the force, and the drive moves on during
    // the step in which the feeler slips: up to 4 mN of 0.45 N, half of it on average.
    let leaning = 1.0 - feeler.shear_stiffness / feeler.normal_stiffness;
    let leaning = leaning * 0.004 / LINK * (limits[0] / feeler.shear_stiffness) / DEPTH;
    let tolerance = TILT + leaning;
    let (way_off, work_off) = (
        (after.0 - before.0) / way - 1.0,
        (after.1 - before.1) / work - 1.0,
    );
    assert!(way_off.abs() < tolerance, "{way_off}");
    assert!(work_off.abs() < 2.0 * tolerance + 0.005, "{work_off}");
}
