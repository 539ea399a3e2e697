//! What every value of the simulated world must be.

use super::check_objects::check_object;
use super::checker::{Checker, MAX};
use feeler_sim::columnar_feeler::{FeelerConfig, Friction};
use feeler_sim::config::SimConfig;
use feeler_sim::holder::HolderConfig;
use feeler_sim::optics_config::OpticsError;
use feeler_sim::torque_sensor::TorqueSensorConfig;

pub(super) fn check_sim(sim: &SimConfig, checker: &mut Checker) {
    checker.between("sim.step", sim.step, 1e-6, 0.1);
    checker.vector("sim.gravity", sim.gravity);
    checker.not_negative("sim.servo.lag", sim.servo.lag);
    checker.positive("sim.servo.encoder_resolution", sim.servo.encoder_resolution);
    checker.between("sim.servo.backlash", sim.servo.backlash, 0.0, 1.0);
    check_feeler("sim.feeler", &sim.feeler, checker);
    for (index, exception) in sim.element.iter().enumerate() {
        let feeler = exception.feeler(&sim.feeler);
        check_feeler(&format!("sim.element[{index}]"), &feeler, checker);
    }
    checker.require(
        "sim.object",
        format!("{} objects", sim.object.len()),
        (1..=MAX_OBJECTS).contains(&sim.object.len()),
        &format!("1 to {MAX_OBJECTS} objects"),
    );
    for (name, object) in &sim.object {
        check_object(&format!("sim.object.{name}"), object, checker);
    }
    check_torque_sensor(&sim.torque_sensor, checker);
    if let Some(holder) = &sim.holder {
        check_holder(holder, checker);
    }
    check_variation(sim, checker);
    let noise = &sim.direct_sensing;
    checker.not_negative("sim.direct_sensing.normal_noise", noise.normal_noise);
    checker.not_negative("sim.direct_sensing.shear_noise", noise.shear_noise);
    if let Err(OpticsError::OutOfRange {
        name,
        low,
        high,
        value,
    }) = sim.optics.check()
    {
        checker.between(&format!("sim.optics.{name}"), value, low, high);
    }
}

/// Far more than a hand could touch.
const MAX_OBJECTS: usize = 64;

fn check_feeler(key: &str, feeler: &FeelerConfig, checker: &mut Checker) {
    let positive = [
        ("normal_stiffness", feeler.normal_stiffness),
        ("shear_stiffness", feeler.shear_stiffness),
        ("tip_radius", feeler.tip_radius),
    ];
    for (field, value) in positive {
        checker.positive(&format!("{key}.{field}"), value);
    }
    let not_negative = [
        ("normal_damping", feeler.normal_damping),
        ("shear_damping", feeler.shear_damping),
        ("normal_shear_coupling", feeler.normal_shear_coupling),
    ];
    for (field, value) in not_negative {
        checker.not_negative(&format!("{key}.{field}"), value);
    }
    if let Some(limit) = feeler.length_limit {
        checker.positive(&format!("{key}.length_limit"), limit);
    }
    if let Some(relaxation) = &feeler.relaxation {
        let key = format!("{key}.relaxation");
        // Rubber that keeps nothing would flow, and take for ever to recover.
        checker.between(&format!("{key}.share"), relaxation.share, 0.0, 0.99);
        checker.positive(&format!("{key}.time"), relaxation.time);
    }
    check_friction(key, feeler.friction(), checker);
}

pub(super) fn check_friction(key: &str, friction: Friction, checker: &mut Checker) {
    let kinetic = friction.kinetic_friction;
    checker.not_negative(&format!("{key}.kinetic_friction"), kinetic);
    checker.not_negative(&format!("{key}.stribeck_speed"), friction.stribeck_speed);
    checker.require(
        &format!("{key}.static_friction"),
        friction.static_friction.to_string(),
        friction.static_friction <= MAX && friction.static_friction >= kinetic,
        &format!("at least {key}.kinetic_friction = {kinetic}, at most {MAX:e}"),
    );
}

fn check_torque_sensor(sensor: &TorqueSensorConfig, checker: &mut Checker) {
    let positive = [
        ("stiffness", sensor.stiffness),
        ("rated_torque", sensor.rated_torque),
        ("gauge_factor", sensor.gauge_factor),
        ("bridge_voltage", sensor.bridge_voltage),
        ("amplifier_gain", sensor.amplifier_gain),
        ("cutoff_frequency", sensor.cutoff_frequency),
        ("converter_range", sensor.converter_range),
    ];
    for (field, value) in positive {
        checker.positive(&format!("sim.torque_sensor.{field}"), value);
    }
    checker.not_negative("sim.torque_sensor.noise", sensor.noise);
    checker.between(
        "sim.torque_sensor.rated_strain",
        sensor.rated_strain,
        1e-9,
        0.1,
    );
    checker.require(
        "sim.torque_sensor.converter_bits",
        sensor.converter_bits.to_string(),
        (1..=24).contains(&sensor.converter_bits),
        "1 to 24",
    );
}

fn check_holder(holder: &HolderConfig, checker: &mut Checker) {
    checker.between("sim.holder.turn_play", holder.turn_play, 0.0, 1.0);
    let Some(lateral) = &holder.lateral else {
        return;
    };
    for (axis, (stiffness, play)) in lateral.stiffness.into_iter().zip(lateral.play).enumerate() {
        let key = format!("sim.holder.lateral.stiffness[{axis}]");
        checker.positive(&key, stiffness);
        let key = format!("sim.holder.lateral.play[{axis}]");
        checker.between(&key, play, 0.0, 0.1);
    }
}

fn check_variation(sim: &SimConfig, checker: &mut Checker) {
    let variation = &sim.variation;
    checker.not_negative("sim.variation.bottle_position", variation.bottle_position);
    checker.not_negative("sim.variation.cap_angle", variation.cap_angle);
    let offset = variation.encoder_offset;
    checker.between("sim.variation.encoder_offset", offset, 0.0, 1.0);
    checker.between("sim.variation.friction", variation.friction, 0.0, 0.99);
    checker.between(
        "sim.variation.kinetic_friction",
        variation.kinetic_friction,
        0.0,
        0.99,
    );
    checker.between("sim.variation.seat_angle", variation.seat_angle, 0.0, 0.99);
}
