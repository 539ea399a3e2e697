//! Servos that move joints of two fingers, such as both jaws of a gripper.

#![cfg(target_os = "linux")]

use crate::support::{PERIOD, Rig, config, config_in, finger, model, share};
use feeler::hand::{Hand, HandState, JointVector};
use feeler_drives::config::{DrivesConfig, TorqueCalibration};
use feeler_drives::emulator::BusFault;
use feeler_drives::packet::Protocol;
use feeler_drives::registers::{DriveMode, Registers};
use feeler_drives::setup::{changes, named_servos, read_angles, servo_range};

/// Angle of the horn by which a joint may miss its target (rad): friction stops the emulated motor of a position mode.
const STUCK: f64 = 0.0245;

fn each_mode(test: impl Fn(Rig)) {
    for protocol in Protocol::ALL {
        for &mode in DriveMode::supported(protocol) {
            test(rig(share(config_in(protocol, mode, 2))));
        }
    }
}

fn rig(config: DrivesConfig) -> Rig {
    Rig::of(config).unwrap_or_else(|error| panic!("{error}"))
}

/// Commands theta1 of both fingers for a second, and returns the distance by which the first one moved (rad).
fn move_by(rig: &mut Rig, velocities: [f64; 2]) -> f64 {
    rig.hand.read(&mut rig.state).unwrap();
    let begin = rig.state.joints[0].position[0];
    let commands =
        velocities.map(|velocity| JointVector::from_slice(&[velocity, 0.0, 0.0]).unwrap());
    for _ in 0..100 {
        rig.hand.read(&mut rig.state).unwrap();
        rig.command.relay(&commands);
        rig.hand.command(&rig.command).unwrap();
        rig.emulator.wait(PERIOD);
    }
    rig.command.set_to_stop();
    for _ in 0..20 {
        rig.hand.read(&mut rig.state).unwrap();
        rig.hand.command(&rig.command).unwrap();
        rig.emulator.wait(PERIOD);
    }
    rig.hand.read(&mut rig.state).unwrap();
    rig.state.joints[0].position[0] - begin
}

/// Counts of the servos by which the joints have their measured positions.
fn counts(config: &DrivesConfig, state: &HandState) -> Vec<f64> {
    let fingers = config.finger.iter().zip(&state.joints);
    let joints = fingers.flat_map(|(drives, joints)| drives.joint.iter().zip(joints.position));
    // The inverse of the equation in the documentation of the table [drives].
    let counts = joints.map(|(joint, position)| {
        let turn = (position - joint.homing_offset) * joint.gear_ratio * f64::from(joint.direction);
        model(config.protocol).to_counts(turn)
    });
    counts.collect()
}

#[test]
fn both_joints_are_measured_by_one_servo() {
    each_mode(|mut rig| {
        assert_eq!(rig.emulator.servos().servos().len(), 3);
        for velocity in [0.0, 0.1, -0.2] {
            for _ in 0..30 {
                rig.period(velocity).unwrap();
            }
            rig.hand.read(&mut rig.state).unwrap();
            let counts = counts(&rig.config, &rig.state);
            let reported = rig.get(Registers::of(rig.config.protocol).position);
            for (joint, counts) in counts.iter().enumerate() {
                // Feetech servos report positions within a turn.
                let away = counts - reported[joint % 3] as f64;
                let turn = model(rig.config.protocol).counts as f64;
                let away = (away + turn / 2.0).rem_euclid(turn) - turn / 2.0;
                // Noise, and motion since the measurement.
                assert!(away.abs() < 4.0, "joint {joint}: {counts}, {reported:?}");
            }
            let [first, other] = [0, 1].map(|finger| rig.state.joints[finger].velocity);
            for (joint, ratio) in [2.0, 0.8, 1.0].into_iter().enumerate() {
                assert!((first[joint] - ratio * other[joint]).abs() < 1e-9);
            }
        }
    });
}

/// The other joint moves half as far as the first one.
#[test]
fn a_servo_follows_the_slowest_of_its_joints() {
    each_mode(|mut rig| {
        let servo = rig.config.finger[0].joint[0].clone();
        let tolerance = servo.turn(STUCK).abs() + 0.01 * 0.2 * 2.0;
        for (velocities, expected) in [
            ([0.2, 0.1], 0.2),
            ([-0.2, -0.1], -0.2),
            ([0.2, 0.05], 0.1),
            ([-0.1, -0.2], -0.1),
            ([0.2, 0.0], 0.0),
            ([0.0, -0.2], 0.0),
            ([0.2, -0.1], 0.0),
        ] {
            let moved = move_by(&mut rig, velocities);
            assert!(
                (moved - expected).abs() < tolerance,
                "{:?} {:?}, {velocities:?}: moved by {moved}",
                servo.model,
                servo.mode
            );
        }
    });
}

/// The first joint opens to the other side, like the rack on the other side of a pinion.
#[test]
fn joints_may_move_in_opposite_directions() {
    for protocol in [Protocol::Dynamixel, Protocol::Feetech] {
        let mut config = share(config_in(protocol, DriveMode::Velocity, 2));
        let middle = (finger().joint_lower() + finger().joint_upper()) / 2.0;
        let first = config.finger[0].joint[0].clone();
        let other = &mut config.finger[1].joint[0];
        other.direction = -first.direction;
        other.homing_offset = middle[0] - other.turn(first.horn(middle[0]));
        let mut rig = rig(config);
        let moved = move_by(&mut rig, [0.2, -0.1]);
        // Reading takes up to 8 % of a period in addition.
        assert!((0.195..0.22).contains(&moved), "{moved}");
        let other = rig.state.joints[1].position[0] - middle[0];
        assert!((other + moved / 2.0).abs() < 0.004, "{other}, {moved}");
        assert!(move_by(&mut rig, [0.2, 0.1]).abs() < 0.01);
    }
}

/// theta2 of finger 1 moves 1.25 times as far as theta2 of finger 0, and reaches its limit first.
#[test]
fn the_tighter_limits_apply() {
    for protocol in Protocol::ALL {
        let modes = DriveMode::supported(protocol).iter();
        for &mode in modes.filter(|&&mode| mode != DriveMode::Velocity) {
            let mut rig = rig(share(config_in(protocol, mode, 2)));
            let registers = Registers::of(protocol);
            let servo = rig.config.finger[0].joint[1].clone();
            // 2 rad/s of the faster joint, rounded up to the servo's unit.
            let unit = servo.known_model().expect("a model").velocity_unit;
            let fastest = rig.get(registers.profile_velocity)[1] as f64 * unit;
            let limit = 2.0 * 0.8 * servo.gear_ratio;
            assert!((limit..limit + unit).contains(&fastest), "{fastest} rad/s");
            let upper = finger().joint_upper()[1];
            for _ in 0..600 {
                rig.hand.read(&mut rig.state).unwrap();
                let command = JointVector::from_slice(&[0.0, 0.5, 0.0]).unwrap();
                rig.command.relay(&[command; 2]);
                rig.hand.command(&rig.command).unwrap();
                rig.emulator.wait(PERIOD);
                let position = rig.positions()[4];
                assert!(position < upper + servo.turn(STUCK).abs(), "{position} rad");
            }
            let [first, other] = [0, 1].map(|finger| rig.state.joints[finger].position[1]);
            assert!((other - upper).abs() < 0.05, "{other} rad");
            assert!(first < finger().joint_upper()[1] - 0.2, "{first} rad");
        }
    }
}

#[test]
fn a_command_above_the_speed_limit_of_either_joint_is_rejected() {
    for velocities in [[2.1, 0.1], [0.1, 2.1], [f64::NAN, 0.1], [0.1, f64::NAN]] {
        let mut rig = rig(share(config(Protocol::Dynamixel, 2)));
        rig.hand.read(&mut rig.state).unwrap();
        let commands = velocities.map(|velocity| JointVector::splat(3, velocity));
        rig.command.relay(&commands);
        let error = rig.hand.command(&rig.command).unwrap_err().to_string();
        let finger = usize::from(velocities[0] == 0.1);
        let words = [
            format!("servo 1 (theta1 of finger {finger}) was commanded"),
            "expected at most 2.00 rad/s".into(),
        ];
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
        rig.settle();
        assert_eq!(rig.goals(), [0.0; 3]);
    }
}

/// A jump of the encoder by two turns takes theta1 of finger 1 beyond its limits, but not theta1 of finger 0.
#[test]
fn a_joint_beyond_its_limits_stops_the_hand() {
    let mut config = share(config(Protocol::Dynamixel, 2));
    let middle = (finger().joint_lower() + finger().joint_upper()) / 2.0;
    let first = &mut config.finger[0].joint[0];
    first.gear_ratio = 40.0;
    let horn = first.horn(middle[0]);
    let other = &mut config.finger[1].joint[0];
    other.homing_offset = middle[0] - other.turn(horn);
    let mut rig = rig(config);
    rig.period(0.0).unwrap();
    rig.emulator.inject(BusFault::Jump(1));
    let error = (0..3).find_map(|_| rig.period(0.0).err());
    let error = error.expect("an error").to_string();
    assert!(
        error.contains("servo 1 (theta1 of finger 1) is at"),
        "{error}"
    );
}

#[test]
fn either_joint_can_be_jogged() {
    each_mode(|mut rig| {
        for (finger, velocity) in [(0, 0.1), (1, 0.08), (1, -0.08)] {
            rig.hand.read(&mut rig.state).unwrap();
            let begin = rig.state.clone();
            for _ in 0..100 {
                rig.hand.read(&mut rig.state).unwrap();
                rig.hand.jog(finger, 0, velocity).unwrap();
                rig.emulator.wait(PERIOD);
            }
            rig.hand.jog(finger, 0, 0.0).unwrap();
            rig.emulator.wait(0.05);
            rig.hand.read(&mut rig.state).unwrap();
            let moved = [0, 1]
                .map(|finger| rig.state.joints[finger].position - begin.joints[finger].position);
            assert!((moved[finger][0] - velocity).abs() < 0.015, "{moved:?}");
            assert!((moved[0][0] - 2.0 * moved[1][0]).abs() < 1e-9, "{moved:?}");
            let still = 0.0015 + model(rig.config.protocol).to_angle(1.0);
            assert!(moved[0][1].abs() < still && moved[0][2].abs() < still);
        }
        // theta1 of finger 0 would move at 0.3 rad/s.
        let error = rig.hand.jog(1, 0, 0.15).unwrap_err().to_string();
        assert!(error.contains("expected at most 0.09 rad/s"), "{error}");
    });
}

/// The range of both joints is written to the servo, and both positions are read from it.
#[test]
fn set_up_respects_both_joints() {
    let config = share(config_in(Protocol::Feetech, DriveMode::Position, 2));
    let fingers = [finger(), finger()];
    let rig = rig(config.clone());
    let registers = Registers::of(Protocol::Feetech);
    let [lower, upper] = registers.position_limits.map(|limit| rig.get(limit));
    let ranges: Vec<_> = upper.iter().zip(&lower).map(|(u, l)| u - l).collect();
    // 120, 150 and 150 degrees of finger 0; the second one is limited to 0.8 times 150 degrees by finger 1.
    assert!((ranges[0] - 1365).abs() <= 1 && (ranges[2] - 1707).abs() <= 1);
    assert!((ranges[1] - 1365).abs() <= 1, "{ranges:?}");
    drop(rig.hand);
    let mut bus = crate::support::master(&rig.emulator, &config);
    for (servo, drive) in named_servos(&config) {
        let range = servo_range(&config, &fingers, servo).unwrap();
        assert!(changes(&mut bus, servo, drive, range).unwrap().is_empty());
        let angles = read_angles(&mut bus, &config, &fingers, servo).unwrap();
        assert_eq!(angles.len(), 2);
        let middle = (finger().joint_lower() + finger().joint_upper())[servo.joint] / 2.0;
        for angle in angles {
            assert!((angle - middle).abs() < 0.006, "{servo}: {angle}");
        }
    }
}

#[test]
fn joints_without_a_common_range_are_refused() {
    let mut config = share(config(Protocol::Dynamixel, 2));
    config.finger[1].joint[0].homing_offset += 5.0;
    let error = Rig::of(config).err().expect("an error").to_string();
    for word in ["servo 1 (theta1 of finger 0)", "theta1 of finger 1", "home"] {
        assert!(error.contains(word), "no {word:?} in {error}");
    }
}

/// The effort of a motor counts for its first joint.
#[test]
fn efforts_are_those_of_the_first_joint() {
    let mut config = share(config(Protocol::Dynamixel, 2));
    config.finger[0].joint[0].torque = Some(TorqueCalibration {
        constant: 0.5,
        constant_error: 0.01,
        friction: 0.01,
        friction_error: 0.0,
    });
    let mut rig = rig(config);
    rig.emulator.inject(BusFault::Load(1, 0.1));
    for _ in 0..20 {
        rig.period(0.1).unwrap();
    }
    let efforts = &rig.state.efforts;
    assert!(efforts[0].effort[0] > 0.05 && efforts[0].effort[1].is_nan());
    assert!(efforts[1].effort.is_empty());
    assert_eq!(rig.hand.torques().count(), 3);
}

#[test]
fn couplings_state_how_far_each_other_joint_moves() {
    assert!(config(Protocol::Dynamixel, 2).couplings().is_empty());
    let mut config = share(config(Protocol::Dynamixel, 2));
    config.finger[1].joint[2].direction *= -1;
    for (joint, (coupling, ratio)) in config.couplings().iter().zip([0.5, 1.25, -1.0]).enumerate() {
        assert_eq!((coupling.first, coupling.other), ((0, joint), (1, joint)));
        assert!((coupling.ratio - ratio).abs() < 1e-12, "{coupling:?}");
    }
    assert_eq!(config.couplings().len(), 3);
}

#[test]
fn mistakes_in_ids_and_keys_are_refused() {
    let refused = |change: &dyn Fn(&mut DrivesConfig), words: &[&str]| {
        let mut config = share(config(Protocol::Dynamixel, 2));
        change(&mut config);
        let error = Rig::of(config).err().expect("an error").to_string();
        for word in words {
            assert!(error.contains(word), "no {word:?} in {error}");
        }
    };
    // An id alone does not couple joints.
    refused(
        &|c| c.finger[1].joint[0] = c.finger[0].joint[0].clone(),
        &["drives.finger[1].joint[0].id = 1", "shared = true"],
    );
    refused(
        &|c| c.finger[1].joint[0].id = 7,
        &[
            "drives.finger[1].joint[0].id = 7",
            "servo of an earlier finger",
        ],
    );
    refused(
        &|c| c.finger[1].joint[1].id = 1,
        &["drives.finger[1].joint[1].id = 1", "one joint per finger"],
    );
    refused(
        &|c| c.finger.swap(0, 1),
        &[
            "drives.finger[0].joint[0].id = 1",
            "servo of an earlier finger",
        ],
    );
    refused(
        &|c| c.finger[1].joint[0].model = "XL330-M288".into(),
        &["finger[1].joint[0].model", "no value with shared = true"],
    );
    refused(
        &|c| c.finger[1].joint[0].mode = Some(DriveMode::Position),
        &[
            "finger[1].joint[0].mode = \"position\"",
            "no value with shared = true",
        ],
    );
    // Also the default.
    refused(
        &|c| c.finger[1].joint[0].mode = Some(DriveMode::Velocity),
        &[
            "finger[1].joint[0].mode = \"velocity\"",
            "no value with shared = true",
        ],
    );
    refused(
        &|c| c.finger[1].joint[0].current_limit = Some(0.5),
        &[
            "finger[1].joint[0].current_limit = 0.5",
            "first joint of the servo",
        ],
    );
    refused(
        &|c| c.finger[1].joint[0].direction = 2,
        &["finger[1].joint[0].direction = 2"],
    );
    refused(
        &|c| c.finger[0].joint[0].model = String::new(),
        &["finger[0].joint[0].model = \"\"", "XL330-M288"],
    );
}

/// A stop because of stale data, and one by the watchdog, hold all joints.
#[test]
fn stale_data_and_a_dead_computer_stop_both_joints() {
    each_mode(|mut rig| {
        for _ in 0..10 {
            rig.period(0.1).unwrap();
        }
        rig.hand.read(&mut rig.state).unwrap();
        rig.refuse_stale_command(0.1);
        assert_eq!(rig.goals(), [0.0; 3]);
        rig.hand.restart().unwrap();
        for _ in 0..10 {
            rig.period(0.1).unwrap();
        }
        if rig.config.protocol == Protocol::Dynamixel {
            rig.emulator.wait(0.15);
            let stopped = rig.positions();
            rig.emulator.wait(0.5);
            for (before, after) in stopped.iter().zip(rig.positions()) {
                assert!((before - after).abs() < 0.004, "{before} to {after}");
            }
        }
    });
}
