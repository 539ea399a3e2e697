//! Positions of servos: homing offsets, wraps, lost turns.

#![cfg(target_os = "linux")]

use crate::support::{PERIOD, Rig, bus, config, config_in, finger, hand_on, plant};
use feeler::hand::Hand;
use feeler_drives::bus::Bus;
use feeler_drives::config::DrivesConfig;
use feeler_drives::emulator::{BusFault, EmulatorConfig, Lockstep};
use feeler_drives::packet::Protocol;
use feeler_drives::registers::{DriveMode, Registers};
use std::f64::consts::TAU;

/// Largest homing offset of a Feetech servo, sign and magnitude of 11 bits.
const LARGEST: i64 = 2047;

/// Writes `offset` to the homing offset of servo 1 and reads it back.
fn set_offset(bus: &Lockstep, config: &DrivesConfig, offset: i64) -> i64 {
    let registers = Registers::of(config.protocol);
    let homing_offset = registers.homing_offset.expect("a homing offset");
    let how = (config.protocol, config.baud_rate);
    let mut master = Bus::on(Box::new(bus.clone()), how, 0.004, bus.clock());
    if let Some(lock) = registers.lock {
        master.write(1, lock, 0).unwrap();
    }
    master.write(1, homing_offset, offset).unwrap();
    if let Some(lock) = registers.lock {
        master.write(1, lock, 1).unwrap();
    }
    bus.wait(0.01);
    master.read(1, homing_offset).unwrap()
}

/// A joint turns through the wrap of its servo, for homing offsets of either sign up to the largest.
#[test]
fn a_feetech_servo_turns_through_its_wrap() {
    for offset in [-LARGEST, -1024, -1, 0, 1, 1500, LARGEST] {
        let mut config = config(Protocol::Feetech, 1);
        let joint = &mut config.finger[0].joint[0];
        // The encoder is at half a turn. The reported position is `2048 - offset`, near which the wrap is moved by
        // half a turn more for each case.
        joint.homing_offset = 0.0;
        let begin = joint.position((2048 - offset) as f64 / 4096.0 * TAU);
        let middle = (finger().joint_lower() + finger().joint_upper()) / 2.0;
        joint.homing_offset = middle[0] - begin;
        let emulator = EmulatorConfig::of(&config, 1);
        let mut angles = vec![TAU / 2.0];
        angles.extend(
            config
                .joints()
                .skip(1)
                .enumerate()
                .map(|(i, joint)| joint.horn(middle[(i + 1) % 3])),
        );
        let plant = feeler_drives::emulator::LagPlant::new(0.01, &angles);
        let lockstep = Lockstep::new(&emulator, Box::new(plant));
        assert_eq!(set_offset(&lockstep, &config, offset), offset);
        let mut rig = Rig::on(lockstep, config).unwrap_or_else(|error| panic!("{error}"));
        // A reported position wraps at 4096.
        let position = rig.get(Registers::of(Protocol::Feetech).position)[0];
        assert!(
            (position - (2048 - offset).rem_euclid(4096)).abs() <= 1,
            "{offset}: {position}"
        );
        rig.period(0.0).unwrap();
        let before = rig.state.joints[0].position[0];
        assert!((before - middle[0]).abs() < 0.003, "{offset}: {before}");
        let mut angle = before;
        for velocity in [0.8, -0.8] {
            for _ in 0..60 {
                rig.period(velocity).unwrap();
                let now = rig.state.joints[0].position[0];
                assert!(
                    (now - angle).abs() < 0.8 * PERIOD * 2.0 + 0.003,
                    "{offset}: {angle} to {now}"
                );
                angle = now;
            }
            let expected = if velocity > 0.0 { 0.8 * 0.6 } else { 0.0 };
            assert!(
                (angle - before - expected).abs() < 0.03,
                "{offset}: {}",
                angle - before
            );
        }
    }
}

/// Asserts that a hand opens if its range is `within` the positions of servo 1. Otherwise the error must name the servo, what
/// is expected by these `words`, and homing.
fn opens_if(within: bool, config: &DrivesConfig, words: &[&str]) {
    let offset = config.finger[0].joint[0].homing_offset;
    match (hand_on(&bus(config), config).map(drop), within) {
        (Ok(()), true) => {}
        (Err(error), false) => {
            let error = error.to_string();
            let mut words = words
                .iter()
                .chain(&["servo 1 (theta1 of finger 0)", "home"]);
            assert!(
                words.all(|word| error.contains(word)),
                "offset {offset}: {error}"
            );
        }
        (Ok(()), false) => panic!("offset {offset}: opened beyond the servo's positions"),
        (Err(error), true) => panic!("offset {offset}: {error}"),
    }
}

/// In position mode, a Feetech servo would turn the other way around to a goal beyond its wrap.
#[test]
fn a_range_across_the_wrap_is_refused_in_position_mode() {
    // The range of 120 degrees takes 683 counts to either side.
    for (middle, within) in [
        (2048, true),
        (700, true),
        (683, true),
        (681, false),
        (0, false),
        (4095, false),
        (4096 - 690, true),
        (4096 - 680, false),
    ] {
        let mut config = config_in(Protocol::Feetech, DriveMode::Position, 1);
        let joint = &mut config.finger[0].joint[0];
        joint.direction = 1;
        joint.homing_offset = -f64::from(middle) * TAU / 4096.0;
        opens_if(within, &config, &["position correction (address 31)"]);
    }
    // Velocity mode follows any wrap, and Dynamixel servos count turns in position mode.
    for config in [
        config(Protocol::Feetech, 1),
        config_in(Protocol::Dynamixel, DriveMode::Position, 1),
    ] {
        hand_on(&bus(&config), &config).unwrap_or_else(|error| panic!("{error}"));
    }
}

/// The servo itself keeps the joint within its limits.
#[test]
fn a_feetech_servo_in_position_mode_gets_the_limits_of_its_joint() {
    // 120, 150 and 150 degrees of 360 and of 300.
    for (protocol, expected, both_ends) in [
        (Protocol::Feetech, [1366, 1706, 1706], 4096),
        (Protocol::FeetechScs, [410, 512, 512], 1024),
    ] {
        let config = config_in(protocol, DriveMode::Position, 1);
        let rig = Rig::of(config).unwrap_or_else(|error| panic!("{error}"));
        let registers = Registers::of(protocol);
        let [lower, upper] = registers.position_limits.map(|limit| rig.get(limit));
        let ranges: Vec<_> = upper.iter().zip(&lower).map(|(u, l)| u - l).collect();
        assert_eq!(ranges, expected);
        assert!((lower[0] + upper[0] - both_ends).abs() <= 1);
    }
}

/// The range of 120 degrees takes 205 counts to either side. A potentiometer neither wraps nor has an offset.
#[test]
fn a_range_beyond_a_potentiometer_is_refused() {
    for (middle, within) in [
        (512, true),
        (206, true),
        (203, false),
        (817, true),
        (820, false),
    ] {
        let mut config = config(Protocol::FeetechScs, 1);
        let joint = &mut config.finger[0].joint[0];
        joint.homing_offset = -(f64::from(middle) * 300.0 / 1024.0).to_radians();
        opens_if(within, &config, &["within 0 to 1023", "near 512"]);
    }
}

/// Dynamixel servos add their homing offset and count turns.
#[test]
fn a_dynamixel_in_position_mode_turns_over_several_turns() {
    for offset in [-1_000_000, -4096, 0, 5000, 1_000_000] {
        for mode in DriveMode::ALL {
            let mut config = config_in(Protocol::Dynamixel, mode, 1);
            let joint = &mut config.finger[0].joint[0];
            joint.gear_ratio = 19.0;
            joint.model = "XL330-M077".into();
            let plant = plant(&config);
            let joint = &mut config.finger[0].joint[0];
            // The joint is 0 at the offset.
            joint.homing_offset = -joint.turn(offset as f64 / 4096.0 * TAU);
            let lockstep = Lockstep::new(&EmulatorConfig::of(&config, 1), plant);
            assert_eq!(set_offset(&lockstep, &config, offset), offset);
            let mut rig = Rig::on(lockstep, config).unwrap_or_else(|error| panic!("{error}"));
            rig.period(0.0).unwrap();
            let before = rig.state.joints[0].position[0];
            for _ in 0..60 {
                rig.period(0.8).unwrap();
            }
            for _ in 0..20 {
                rig.period(0.0).unwrap();
            }
            // 0.48 rad of the joint are 1.45 turns of the servo.
            let turned = rig.state.joints[0].position[0] - before;
            assert!(
                (turned - 0.48).abs() < 0.015,
                "{mode:?}, {offset}: {turned}"
            );
        }
    }
}

/// A servo with a gear that restarts counts from its first turn.
#[test]
fn a_restart_in_another_turn_is_refused() {
    for mode in DriveMode::ALL {
        let config = config_in(Protocol::Dynamixel, mode, 1);
        let mut rig = Rig::of(config).unwrap_or_else(|error| panic!("{error}"));
        // Servo 3 (gear ratio 3, direction 1, range of 150 degrees) is in its turn -1 at the middle of the range.
        let position = Registers::of(Protocol::Dynamixel).position;
        let before = rig.get(position);
        assert!(before[2] < 0, "{before:?}");
        rig.period(0.0).unwrap();
        rig.emulator.inject(BusFault::Reboot(3));
        let error = (0..50)
            .find_map(|_| rig.period(0.0).err())
            .expect("an error");
        assert!(error.to_string().contains("servo 3"), "{error}");
        rig.emulator.wait(0.5);
        assert!((0..4096).contains(&rig.get(position)[2]));
        let error = rig.hand.restart().unwrap_err().to_string();
        let words = ["servo 3 (theta3 of finger 0)", "home", "rad"];
        assert!(
            words.iter().all(|word| error.contains(word)),
            "{mode:?}: {error}"
        );
        assert!(rig.hand.command(&rig.command).is_err());
        // A servo in its first turn continues.
        let mut config = config_in(Protocol::Dynamixel, mode, 1);
        config.finger[0].joint[2].gear_ratio = 1.0;
        config.finger[0].joint[2].homing_offset = -TAU / 2.0;
        let mut rig = Rig::of(config).unwrap_or_else(|error| panic!("{error}"));
        rig.period(0.0).unwrap();
        rig.emulator.inject(BusFault::Reboot(3));
        (0..50)
            .find_map(|_| rig.period(0.0).err())
            .expect("an error");
        rig.emulator.wait(0.5);
        rig.hand
            .restart()
            .unwrap_or_else(|error| panic!("{mode:?}: {error}"));
        rig.period(0.1).unwrap();
    }
}
