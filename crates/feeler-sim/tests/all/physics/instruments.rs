//! Drives, encoders and the torque sensor, compared with their textbook formulas.

use crate::rig;
use feeler::hand::{Hand, HandCommand, HandState, JointVector};
use feeler_sim::random::{Purpose, generator};
use feeler_sim::rig::{Joints, ServoConfig, SimHand, SimRig, TorqueSensorConfig};
use feeler_sim::world::{SimConfig, World};
use std::path::Path;

const SERVO: ServoConfig = ServoConfig {
    lag: 0.01,
    encoder_resolution: 1e-5,
    backlash: 0.0,
};

/// A world with both fingers of the rig.
fn world(sim: &SimConfig, seed: u64) -> World {
    let joints = [[0.0, 1.0, -1.0].into(), [0.0, -1.0, 1.0].into()];
    World::new(sim, &rig::fingers(2), &joints, Path::new(""), seed).expect("a world")
}

fn free() -> (JointVector, JointVector) {
    (JointVector::splat(3, -10.0), JointVector::splat(3, 10.0))
}

#[test]
fn a_joint_follows_its_command_along_the_exponential() {
    let start = JointVector::from([0.1, -0.2, 0.3]);
    let command = JointVector::from([0.5, -1.0, 0.0]);
    for step in [0.001, 0.0007, 0.02] {
        let mut joints = Joints {
            command,
            ..Joints::at_rest(start)
        };
        let remaining = SERVO.remaining_error(step);
        for n in 1..=200 {
            SERVO.advance(&mut joints, step, remaining, free());
            let t = step * f64::from(n);
            let rise = 1.0 - (-t / SERVO.lag).exp();
            // v = c (1 - e^(-t/T)), x = x0 + c (t - T (1 - e^(-t/T))) is exact at any step size: only the rounding of
            // 200 steps remains.
            assert!((joints.velocity - rise * command).length() < 1e-13);
            let position = start + command * (t - SERVO.lag * rise);
            assert!((joints.position - position).length() < 1e-13);
        }
    }
}

#[test]
fn a_joint_stops_at_its_limit_and_can_leave_it() {
    let mut joints = Joints::at_rest(JointVector::zeros(3));
    let limits = (JointVector::splat(3, -0.1), JointVector::splat(3, 0.1));
    let mut run = |first: f64| {
        joints.command = [first, 0.0, 0.0].into();
        for _ in 0..200 {
            SERVO.advance(&mut joints, 0.001, SERVO.remaining_error(0.001), limits);
        }
        joints
    };
    let stopped = run(1.0);
    assert_eq!((stopped.position[0], stopped.velocity[0]), (0.1, 0.0));
    assert!(run(-1.0).position[0] < 0.0);
}

#[test]
fn a_servo_without_lag_has_its_commanded_velocity_at_once() {
    let servo = ServoConfig { lag: 0.0, ..SERVO };
    let mut joints = Joints {
        command: [1.0, 0.0, 0.0].into(),
        ..Joints::at_rest(JointVector::zeros(3))
    };
    servo.advance(&mut joints, 0.001, servo.remaining_error(0.001), free());
    assert_eq!((joints.position[0], joints.velocity[0]), (0.001, 1.0));
}

#[test]
fn encoders_round_to_whole_counts_and_velocity_is_their_difference() {
    let mut world = world(&rig::sim(), 0);
    let resolution = world.model().servo.encoder_resolution;
    world.command(0, JointVector::zeros(3));
    let mut hand = SimHand::new(SimRig::new(world), 10);
    let mut state = HandState::zero(2);
    let mut before = None;
    let velocity = vec![JointVector::from([0.0123, -0.0171, 0.0031]); 2];
    for _ in 0..20 {
        hand.read(&mut state).expect("a state");
        let now = state.joints[0].position;
        let counts = now / resolution;
        // Angles of a few rad are 1e5 counts: rounding errors are 1e-11 of a count.
        assert!((counts - counts.map(f64::round)).abs().max_element() < 1e-9);
        if let Some(before) = before {
            let difference: JointVector = (now - before) / 0.01;
            assert!((state.joints[0].velocity - difference).length() < 1e-12);
        }
        before = Some(now);
        let mut command = HandCommand::stop(velocity.len());
        command.relay(&velocity);
        hand.command(&command).expect("a command");
    }
    // After 20 time constants the joint moves as commanded, measured to one count in either direction.
    let error = state.joints[0].velocity - velocity[0];
    assert!(error.abs().max_element() <= resolution / 0.01, "{error}");
}

#[test]
fn encoders_have_a_constant_offset_from_power_up() {
    let most = 0.01;
    let mut sim = rig::sim();
    sim.variation.encoder_offset = most;
    let (mut drawn, runs) = (Vec::new(), 100);
    for seed in 0..runs {
        let mut world = world(&sim, seed);
        world.step().expect("a step");
        let mut offsets = Vec::new();
        for (finger, own) in world.model().fingers.iter().enumerate() {
            let (read, joints) = (world.encoded(finger), &world.state().fingers[finger].joints);
            let off = read - joints.position;
            // To half a count.
            assert!((off - own.encoder_offset).abs().max_element() <= 0.5e-5 + 1e-12);
            offsets.extend(off.iter());
        }
        assert!(offsets.iter().all(|off| off.abs() <= most + 0.5e-5));
        drawn.extend(offsets);
    }
    // Uniform: the mean's standard deviation is most / sqrt(3 n); four of them are exceeded less than once in 10 000.
    let count = drawn.len() as f64;
    assert_eq!(drawn.len(), 6 * runs as usize);
    let mean = drawn.iter().sum::<f64>() / count;
    assert!(mean.abs() < 4.0 * most / (3.0 * count).sqrt(), "{mean}");
    let spread = drawn.iter().map(|off| off * off).sum::<f64>() / count;
    // The variance of a uniform number's square is 4 / 45.
    let tolerance = 4.0 * (4.0 / 45.0 / count).sqrt();
    assert!(
        (spread / most.powi(2) - 1.0 / 3.0).abs() < tolerance,
        "{spread}"
    );
}

const TORQUE_SENSOR: TorqueSensorConfig = TorqueSensorConfig {
    stiffness: 50.0,
    rated_torque: 0.2,
    rated_strain: 0.0005,
    gauge_factor: 2.1,
    bridge_voltage: 5.0,
    amplifier_gain: 1000.0,
    cutoff_frequency: 200.0,
    noise: 0.0,
    converter_range: 10.0,
    converter_bits: 14,
};

#[test]
fn the_bridge_obeys_the_full_bridge_formula() {
    let mut random = generator(0, Purpose::TorqueNoise);
    for n in -30..=30 {
        let torque = 0.01 * f64::from(n);
        let reading = TORQUE_SENSOR.read(torque, &mut random);
        // Four active gauges: V = V_ex GF strain. The formula is exact at a strain of 5e-4, as stretched and compressed
        // gauges change equally.
        let strain = TORQUE_SENSOR.rated_strain * torque / TORQUE_SENSOR.rated_torque;
        let expected = 1000.0 * 5.0 * 2.1 * strain;
        assert!(
            (reading.voltage - expected).abs() < 1e-9,
            "{}",
            reading.voltage
        );
        // Half a count of 20 V / 2^14, in N m.
        let half_count = 10.0 / 16384.0 / (1000.0 * 5.0 * 2.1 * 0.0005) * 0.2;
        assert!((reading.torque - torque).abs() <= half_count * (1.0 + 1e-9));
    }
}

#[test]
fn the_converter_clips_at_its_range() {
    let mut random = generator(0, Purpose::TorqueNoise);
    let top = TORQUE_SENSOR.read(1.0, &mut random);
    let bottom = TORQUE_SENSOR.read(-1.0, &mut random);
    assert_eq!((top.counts, bottom.counts), (8191, -8192));
    // 10 V at 26.25 V per N m; the upper end is one count lower.
    assert!((bottom.torque + 10.0 / 26.25).abs() < 1e-12);
    assert!((top.torque - 10.0 / 26.25 * 8191.0 / 8192.0).abs() < 1e-12);
}
