//! Modes of the servos: motion, stops, stalled joints, and limits of the current under every fault.

#![cfg(target_os = "linux")]

use crate::support::{
    CURRENT_LIMIT, MAX_AGE, PERIOD, Rig, ages_of_commands, ages_of_goal_positions, config_in,
    finger, model, plant, share,
};
use feeler::hand::{Hand, JointVector};
use feeler_drives::config::{DrivesConfig, TorqueCalibration};
use feeler_drives::emulator::{BusFault, EmulatorConfig, LoadedPlant, Lockstep};
use feeler_drives::packet::Protocol;
use feeler_drives::registers::{DriveMode, Registers};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Speed limit of the joints (rad/s), and their leash by default (rad).
const SPEED: f64 = 2.0;
const LEASH: f64 = SPEED * MAX_AGE;

fn each_mode(test: impl Fn(Protocol, DriveMode)) {
    for protocol in Protocol::ALL {
        for &mode in DriveMode::supported(protocol) {
            test(protocol, mode);
        }
    }
}

fn each_position_mode(test: impl Fn(Protocol, DriveMode)) {
    each_mode(|protocol, mode| {
        if mode != DriveMode::Velocity {
            test(protocol, mode);
        }
    });
}

/// Angle of the horn between two positions (rad).
fn count(protocol: Protocol) -> f64 {
    model(protocol).to_angle(1.0)
}

/// Distance to the goal at which the friction of an emulated servo stops it, with a count of noise (rad of the horn).
fn stuck(protocol: Protocol) -> f64 {
    0.02 * 0.43 + count(protocol) + 0.0005
}

fn rig(protocol: Protocol, mode: DriveMode) -> Rig {
    let rig = Rig::of(config_in(protocol, mode, 2));
    rig.unwrap_or_else(|error| panic!("{protocol:?} {mode:?}: {error}"))
}

/// Joints turn as commanded, for any direction, gear ratio and offset, and stay where they are stopped.
#[test]
fn joints_follow_velocities_in_every_mode() {
    each_mode(|protocol, mode| {
        let mut rig = rig(protocol, mode);
        let registers = Registers::of(protocol);
        if let Some(register) = registers.mode {
            assert_eq!(rig.get(register), [mode.number(protocol); 6]);
        }
        for speed in [0.2, -0.2] {
            rig.period(0.0).unwrap();
            let begin = rig.state.clone();
            for _ in 0..60 {
                rig.period(speed).unwrap();
            }
            for _ in 0..20 {
                rig.period(0.0).unwrap();
            }
            for (joints, begin) in rig.state.joints.iter().zip(&begin.joints) {
                // The first command of a position mode does not move the goal yet, and the goal does not advance after
                // the last one.
                let turned = joints.position - begin.position;
                let off = turned - JointVector::splat(3, 60.0 * PERIOD * speed);
                let most = 2.0 * stuck(protocol) + 0.2 * 1.5 * PERIOD;
                assert!(
                    off.abs().max_element() < most,
                    "{protocol:?} {mode:?}: turned by {turned}"
                );
                assert!(joints.velocity.abs().max_element() < 0.03, "{joints:?}");
            }
        }
    });
}

/// Emulated servos begin with other goals, as a program before may have left them.
#[test]
fn no_joint_moves_when_torque_is_switched_on() {
    each_mode(|protocol, mode| {
        let mut rig = rig(protocol, mode);
        let begin = rig.positions();
        for _ in 0..30 {
            rig.period(0.0).unwrap();
        }
        for (begin, end) in begin.iter().zip(rig.positions()) {
            assert!(
                (begin - end).abs() < 0.0025 + count(protocol),
                "{protocol:?} {mode:?}: {begin} to {end}"
            );
        }
    });
}

/// A wall that stops the joint of servo 1 in its positive direction, until it is removed.
fn rig_with_wall(protocol: Protocol, mode: DriveMode) -> (Rig, Arc<AtomicBool>) {
    let config = config_in(protocol, mode, 1);
    let middle = (finger().joint_lower() + finger().joint_upper()) / 2.0;
    let joint = &config.finger[0].joint[0];
    let wall = joint.horn(middle[0] + 0.05);
    let stands = Arc::new(AtomicBool::new(true));
    let flag = stands.clone();
    let plant = LoadedPlant::new(*plant(&config), move |servo, motion| {
        let pressed = (motion.angle - wall).max(0.0);
        let is_pressed = servo == 0 && flag.load(Ordering::Relaxed);
        if is_pressed { 20.0 * pressed } else { 0.0 }
    });
    let bus = Lockstep::new(&EmulatorConfig::of(&config, 1), Box::new(plant));
    let rig = Rig::on(bus, config).unwrap_or_else(|error| panic!("{error}"));
    (rig, stands)
}

/// Commands servo 1 only.
fn push(rig: &mut Rig, velocity: f64) {
    rig.hand.read(&mut rig.state).unwrap();
    rig.command
        .relay(&[JointVector::from_slice(&[velocity, 0.0, 0.0]).unwrap()]);
    rig.hand.command(&rig.command).unwrap();
    rig.emulator.wait(PERIOD);
}

#[test]
fn a_stalled_joint_never_winds_up() {
    each_position_mode(|protocol, mode| {
        let (mut rig, wall) = rig_with_wall(protocol, mode);
        let goal = Registers::of(protocol).goal_position;
        for _ in 0..500 {
            push(&mut rig, 0.5);
            let joint = &rig.config.finger[0].joint[0];
            let horn = model(protocol).to_angle(rig.get(goal)[0] as f64);
            let lead = joint.position(horn) - rig.positions()[0];
            assert!(
                lead.abs() < LEASH + 0.02,
                "{protocol:?} {mode:?}: {lead} rad"
            );
        }
        let stalled = rig.positions()[0];
        wall.store(false, Ordering::Relaxed);
        for _ in 0..50 {
            push(&mut rig, 0.0);
        }
        let moved = rig.positions()[0] - stalled;
        assert!(
            moved < LEASH + 0.01 + count(protocol),
            "{protocol:?} {mode:?}: {moved} rad after the wall fell"
        );
        // It comes back at once.
        for _ in 0..30 {
            push(&mut rig, -0.5);
        }
        let back = rig.positions()[0] - stalled;
        assert!(back < -0.04, "{protocol:?} {mode:?}: {back} rad");
    });
}

/// A joint that presses on a wall in current-limited mode exerts no more than the limit, and is not overloaded.
#[test]
fn a_stalled_joint_keeps_the_limit_of_its_current() {
    for protocol in [Protocol::Dynamixel, Protocol::Feetech] {
        let config = config_in(protocol, DriveMode::CurrentLimitedPosition, 1);
        let torque = TorqueCalibration {
            constant: 0.5,
            constant_error: 0.01,
            friction: 0.0,
            friction_error: 0.0,
        };
        for (current_limit, torque_limit, most) in [
            (Some(0.2), None, 0.2),
            (None, Some(0.05), 0.1),
            (Some(0.05), Some(1.0), 0.05),
        ] {
            let mut config = config.clone();
            for joint in &mut config.finger[0].joint {
                joint.current_limit = current_limit;
                joint.torque_limit = torque_limit;
                joint.torque = Some(torque);
                // Long enough for more than the limit.
                joint.leash = Some(0.5);
            }
            let middle = (finger().joint_lower() + finger().joint_upper()) / 2.0;
            let begin = config.finger[0].joint[0].horn(middle[0]);
            let plant = LoadedPlant::new(*plant(&config), move |servo, motion| match servo {
                0 => 20.0 * (motion.angle - begin),
                _ => 0.0,
            });
            let bus = Lockstep::new(&EmulatorConfig::of(&config, 1), Box::new(plant));
            let mut rig = Rig::on(bus, config).unwrap_or_else(|error| panic!("{error}"));
            for _ in 0..300 {
                push(&mut rig, 0.3);
            }
            let servos = rig.emulator.servos().servos().to_vec();
            let greatest = servos[0].greatest_current();
            assert!(
                greatest <= most,
                "{protocol:?}: {greatest} A, expected at most {most} A"
            );
            assert!(
                greatest > 0.9 * most - 0.005,
                "{protocol:?}: {greatest} A of {most} A"
            );
            let (_, measured) = rig.hand.currents().next().expect("a joint");
            // A unit, and the noise of 1 % of the stall current, at most 3.25 A.
            assert!(
                (measured - greatest).abs() < 0.01 + 0.0325,
                "{protocol:?}: {measured} A"
            );
            let (_, torque) = rig.hand.torques().next().expect("a joint");
            let torque = torque.expect("a calibration");
            assert!((torque.torque - 0.5 * measured).abs() < 1e-12, "{torque:?}");
        }
    }
}

#[test]
fn stale_joint_angles_move_no_goal() {
    each_mode(|protocol, mode| {
        let mut rig = rig(protocol, mode);
        for _ in 0..10 {
            rig.period(0.2).unwrap();
        }
        rig.hand.read(&mut rig.state).unwrap();
        let goals = rig.get(Registers::of(protocol).goal_position);
        rig.refuse_stale_command(0.2);
        assert_eq!(rig.goals(), [0.0; 6]);
        assert_eq!(rig.get(Registers::of(protocol).goal_position), goals);
        rig.hand.restart().unwrap();
        rig.period(0.2).unwrap();
    });
}

/// Without new joint angles, repeated commands do not advance goal positions.
#[test]
fn goal_positions_advance_only_with_new_joint_angles() {
    for protocol in Protocol::ALL {
        let mut rig = rig(protocol, DriveMode::Position);
        for _ in 0..10 {
            rig.period(0.2).unwrap();
        }
        rig.hand.read(&mut rig.state).unwrap();
        rig.command(0.2).unwrap();
        rig.emulator.wait(0.002);
        let goals = rig.get(Registers::of(protocol).goal_position);
        for _ in 0..5 {
            rig.command(0.2).unwrap();
            rig.emulator.wait(0.004);
        }
        assert_eq!(rig.get(Registers::of(protocol).goal_position), goals);
    }
}

#[test]
fn the_watchdogs_stop_the_motors_in_every_mode_if_the_computer_fails() {
    for mode in DriveMode::ALL {
        let mut rig = rig(Protocol::Dynamixel, mode);
        for _ in 0..10 {
            rig.period(0.2).unwrap();
        }
        rig.emulator.wait(0.15);
        assert_eq!(
            rig.get(Registers::of(Protocol::Dynamixel).watchdog.unwrap()),
            [-1; 6]
        );
        let stopped = rig.positions();
        rig.emulator.wait(0.5);
        for (before, after) in stopped.iter().zip(rig.positions()) {
            assert!(
                (before - after).abs() < 0.004,
                "{mode:?}: {before} to {after}"
            );
        }
        let error = (0..20).find_map(|_| rig.period(0.2).err());
        let error = error.expect("an error").to_string();
        assert!(error.contains("bus watchdog"), "{mode:?}: {error}");
    }
}

/// Every kind of fault.
fn faults() -> Vec<BusFault> {
    vec![
        BusFault::FlipBytes(0.01),
        BusFault::LoseBytes(0.01),
        BusFault::Echo,
        BusFault::Silent(5),
        BusFault::Reboot(1),
        BusFault::CablePulled,
        BusFault::Late(1.0),
        BusFault::Latency(0.016),
        BusFault::Overheat(4),
        BusFault::Undervoltage(2),
        BusFault::Hardware(6, 0x20),
        BusFault::Hardware(2, 0x04),
        BusFault::Jump(3),
        BusFault::Load(1, 0.1),
        BusFault::Load(4, -2.0),
    ]
}

/// Moves faults of servos 4 to 6 to servos 1 to 3.
fn among_three(fault: BusFault) -> BusFault {
    match fault {
        BusFault::Silent(id) => BusFault::Silent(id - 3),
        BusFault::Overheat(id) => BusFault::Overheat(id - 3),
        BusFault::Hardware(id, bits) if id > 3 => BusFault::Hardware(id - 3, bits),
        BusFault::Load(id, torque) if id > 3 => BusFault::Load(id - 3, torque),
        fault => fault,
    }
}

/// Returns `true` if the fault moves joints of servo `id`, or changes its positions without motion.
fn moves(fault: BusFault, id: u8) -> bool {
    match fault {
        BusFault::Reboot(own) | BusFault::Jump(own) | BusFault::Load(own, _) => own == id,
        _ => false,
    }
}

/// In every mode and under every fault: no goal moves on joint angles older than the limit, no current exceeds the limit
/// of its mode, and the joints stand still after the fault was noticed.
#[test]
fn no_fault_in_any_mode_moves_a_joint_on_stale_data_or_above_its_limit() {
    each_mode(|protocol, mode| {
        let config = config_in(protocol, mode, 2);
        for fault in faults() {
            check_fault(&config, mode, fault);
            check_fault(&share(config.clone()), mode, among_three(fault));
        }
    });
}

fn check_fault(config: &DrivesConfig, mode: DriveMode, fault: BusFault) {
    let (protocol, servos) = (config.protocol, config.servos().count());
    let context = format!("{protocol:?} {mode:?} {fault:?} {servos} servos");
    let mut rig = Rig::of(config.clone()).unwrap_or_else(|error| panic!("{context}: {error}"));
    for _ in 0..10 {
        rig.period(0.2).unwrap();
    }
    rig.emulator.inject(fault);
    let begin = rig.positions();
    let stopped = (0..100).any(|_| rig.period(0.2).is_err());
    let duration = 100.0 * PERIOD;
    rig.emulator.wait(0.3);
    let still = rig.positions();
    rig.emulator.wait(0.3);
    let bus = rig.emulator.servos();
    assert_eq!(bus.servos().len(), servos);
    for (time, age) in ages_of_commands(&bus, protocol)
        .into_iter()
        .chain(ages_of_goal_positions(&bus, protocol))
    {
        assert!(age <= MAX_AGE + 1e-3, "{context}: {age} s old at {time} s");
    }
    for servo in bus.servos() {
        let greatest = servo.greatest_current();
        let most = match mode {
            DriveMode::CurrentLimitedPosition => CURRENT_LIMIT,
            _ => servo.model.stall.1,
        };
        assert!(
            greatest <= most + 1e-9,
            "{context}: {greatest} A, servo {}",
            servo.id
        );
    }
    drop(bus);
    // Feetech servos in velocity mode have no watchdog and continue if no stop reaches them.
    if protocol == Protocol::Feetech && mode == DriveMode::Velocity {
        return;
    }
    let ids: Vec<_> = config.joints().map(|joint| joint.id).collect();
    let positions = begin.iter().zip(&still).zip(rig.positions());
    for (joint, ((begin, still), end)) in positions.enumerate() {
        if moves(fault, ids[joint]) {
            continue;
        }
        let moved = (still - end).abs();
        assert!(
            !stopped || moved < 0.0045 + count(protocol),
            "{context}: joint {joint} moved by {moved} rad"
        );
        let moved = (begin - still).abs();
        assert!(
            moved < 0.2 * duration + LEASH,
            "{context}: joint {joint} moved by {moved} rad"
        );
    }
}
