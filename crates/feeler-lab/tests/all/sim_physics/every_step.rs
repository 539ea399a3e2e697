//! Invariants of every physics step of the reference run.

use super::reference::{commands, experiment, replay, world};
use feeler_sim::objects::{Motion, ThreadConfig};
use feeler_sim::world::{Contact, World};
use glam::DVec3;

/// Torque of the fingers' contacts about the cap's axis (N·m), from forces and contact points in W.
fn contact_torque(world: &World) -> f64 {
    let pose = world.state().objects[0].pose;
    let fingers = world.model().fingers.iter().zip(&world.state().fingers);
    let contacts = fingers.flat_map(|(model, finger)| {
        finger.contacts.iter().map(move |contact| {
            let anchor = &contact.anchor;
            let point = anchor.position - model.feelers[contact.element].tip_radius * anchor.normal;
            let force = finger.forces[contact.element];
            (pose.rotation * point).cross(force).z
        })
    });
    contacts.sum()
}

/// The thread of the cap in `world`.
fn thread(world: &World) -> &ThreadConfig {
    match &world.model().objects[0].motion {
        Motion::Turns(hinge) => &hinge.thread,
        other => panic!("expected a cap on a thread, got {other:?}"),
    }
}

/// Tolerance of the torque balance (N·m): torques are solved to 1e-9 N·m, two are compared and summed over 82 feelers.
const BALANCE: f64 = 3e-9;

#[test]
fn the_fingers_torque_equals_the_shafts_and_obeys_the_thread() {
    let experiment = experiment(&[]);
    let commands = commands(&experiment);
    let mut world = world(&experiment, &commands.start);
    let (mut worst, mut turning_steps) = (0.0_f64, 0);
    replay(&mut world, &commands, |world, _| {
        let (state, cap) = (world.state(), world.state().objects[0].turn);
        let torque = contact_torque(world);
        let shaft = world.model().torque_sensor.stiffness * cap.twist;
        let imbalance = (torque - cap.torque).abs().max((torque - shaft).abs());
        worst = worst.max(imbalance);
        assert!(
            imbalance < BALANCE,
            "{imbalance:e} N m at {} s: fingers {torque}, cap {cap:?}, shaft {shaft}",
            state.time
        );
        let resisting = thread(world).resisting_torque(cap.angle);
        if cap.turning {
            turning_steps += 1;
            let excess = torque.abs() - resisting;
            assert!(
                excess.abs() < BALANCE,
                "{excess:e} N m at {} s while turning",
                state.time
            );
        } else {
            let breakaway = thread(world).static_factor * resisting;
            assert!(torque.abs() < breakaway + BALANCE);
        }
    });
    println!("worst imbalance {worst:e} N m, {turning_steps} steps turning");
    assert!(turning_steps > 100);
}

#[test]
fn the_torque_sensor_measures_the_torque_within_noise_and_quantisation() {
    let experiment = experiment(&[]);
    let commands = commands(&experiment);
    let mut world = world(&experiment, &commands.start);
    let sensor = world.model().torque_sensor.clone();
    let volts_per_torque =
        sensor.amplifier_gain * sensor.bridge_voltage * sensor.gauge_factor * sensor.rated_strain
            / sensor.rated_torque;
    let count = 2.0 * sensor.converter_range / f64::from(1 << sensor.converter_bits);
    // Six standard deviations: one reading in 5e8 exceeds them, and there are fewer than 2e4.
    let tolerance = (6.0 * sensor.noise + count / 2.0) / volts_per_torque;
    // Repeats the low-pass on the true torque.
    let keep = (-std::f64::consts::TAU * sensor.cutoff_frequency * world.model().step).exp();
    let (mut expected, mut sum_of_squares, mut readings) = (0.0, 0.0, 0.0);
    replay(&mut world, &commands, |world, _| {
        expected = keep * expected + (1.0 - keep) * world.state().objects[0].turn.torque;
        let error = world.read_torque().torque - expected;
        assert!(error.abs() < tolerance, "{error} N m");
        sum_of_squares += error * error;
        readings += 1.0;
    });
    // The variances of noise and rounding add. Over 1e4 readings a standard deviation is estimated to 1 %.
    let deviation = (sensor.noise.powi(2) + count * count / 12.0).sqrt() / volts_per_torque;
    let measured = (sum_of_squares / readings).sqrt();
    assert!(
        (measured / deviation - 1.0).abs() < 0.03,
        "{measured} {deviation}"
    );
}

#[test]
fn feelers_push_within_the_friction_cone_and_only_where_they_touch() {
    let experiment = experiment(&[]);
    let commands = commands(&experiment);
    let mut world = world(&experiment, &commands.start);
    let (radius, height) = (0.014, 0.020);
    let (mut touching, mut worst) = (0_u64, 0.0_f64);
    replay(&mut world, &commands, |world, _| {
        let pose = world.state().objects[0].pose;
        for (model, finger) in world.model().fingers.iter().zip(&world.state().fingers) {
            for element in 0..model.normals.len() {
                let (feeler, force) = (&model.feelers[element], finger.forces[element]);
                let contact = finger.contacts.iter().find(|c| c.element == element);
                let Some(Contact { anchor, .. }) = contact else {
                    assert_eq!(force, DVec3::ZERO, "force without contact");
                    let axis = finger.tip.rotation * model.normals[element];
                    let tip = finger.tip.position + model.dome_radius * axis - pose.position;
                    let above = distance(tip, radius, height);
                    // A feeler that was just released may penetrate by the motion of one step (20 mm/s).
                    assert!(above > feeler.tip_radius - 2e-5, "{above} m and no contact");
                    continue;
                };
                touching += 1;
                let normal = pose.rotation * anchor.normal;
                let pressing = -force.dot(normal);
                assert!(pressing >= 0.0, "element {element} pulls with {pressing} N");
                let shear = (force + pressing * normal).length();
                let use_of_cone = shear / (feeler.static_friction * pressing);
                worst = worst.max(use_of_cone);
                // Slips end within 1e-9 of the normal force; the cap's last adjustment moves a tip by rounding.
                assert!(
                    use_of_cone < 1.0 + 1e-6,
                    "{use_of_cone} of the friction cone"
                );
                // The deformed tip's sphere rests on the cap: its centre is one radius above the surface, up to the
                // distance it rolls along the tangent (2 um and a step or two) before it is projected back.
                let above = distance(pose.rotation * anchor.position, radius, height);
                let tangent = (6e-6_f64).powi(2) / (2.0 * radius);
                assert!((above - feeler.tip_radius).abs() < tangent, "{above} m");
            }
        }
    });
    println!("{touching} contacts, at most {worst} of the friction cone");
    assert!(touching > 10_000);
}

/// Signed distance (m) of `point` from the surface of an upright cylinder about the origin, negative inside.
///
/// Independent of the geometry library.
fn distance(point: DVec3, radius: f64, height: f64) -> f64 {
    let out = point.truncate().length() - radius;
    let up = point.z.abs() - height / 2.0;
    out.max(up).min(0.0) + out.max(0.0).hypot(up.max(0.0))
}
