//! Motion, faults and determinism of a hand on an emulated bus in lockstep.

#![cfg(target_os = "linux")]

use crate::support::{
    MAX_AGE, PERIOD, Rig, ages_of_commands, ages_of_goal_positions, bus, config, config_in, finger,
    hand_on, plant,
};
use feeler::hand::{Hand, JointVector};
use feeler_drives::bus::Bus;
use feeler_drives::config::{DrivesConfig, TorqueCalibration};
use feeler_drives::emulator::{BusFault, EmulatorConfig, Lockstep};
use feeler_drives::hand::DriveHand;
use feeler_drives::packet::instruction::STATUS;
use feeler_drives::packet::{Protocol, encode};
use feeler_drives::registers::{DriveMode, Registers};
use feeler_drives::{Port, RigClock};
use std::io;

/// Protocols with a velocity mode, in which [`config`] operates their servos.
const PROTOCOLS: [Protocol; 2] = [Protocol::Dynamixel, Protocol::Feetech];

/// Joints turn as commanded, for any direction, gear ratio and offset of their servos. Half a unit of velocity of the
/// coarsest servo is 12 mrad/s, so rounding errors must not accumulate.
#[test]
fn joints_turn_as_commanded() {
    for protocol in PROTOCOLS {
        let mut rig = Rig::new(protocol);
        rig.period(0.0).unwrap();
        let geometry = finger();
        let middle = (geometry.joint_lower() + geometry.joint_upper()) / 2.0;
        for joints in &rig.state.joints {
            let off = (joints.position - middle).abs().max_element();
            assert!(
                off < 0.002,
                "{protocol:?}: expected {middle}, got {joints:?}"
            );
        }
        let (begin, start) = (rig.state.clone(), rig.now());
        for _ in 0..60 {
            rig.period(0.05).unwrap();
        }
        let turned = 0.05 * (rig.now() - start);
        rig.period(0.0).unwrap();
        rig.settle();
        rig.period(0.0).unwrap();
        for (joints, begin) in rig.state.joints.iter().zip(&begin.joints) {
            let off = joints.position - begin.position - JointVector::splat(3, turned);
            // A count of 1.5 mrad at either end, with noise of 0.3 counts, and one unit of velocity for the period of
            // the last command.
            let most = 0.004 + 0.024 * PERIOD;
            assert!(
                off.abs().max_element() < most,
                "{protocol:?}: error of {off} after {turned} rad"
            );
            assert!(joints.velocity.abs().max_element() < 0.03, "{joints:?}");
        }
        // Stamps are the bus time at which the responses had arrived.
        assert!(
            rig.state.stamp < rig.now() - PERIOD && rig.state.stamp > rig.now() - 1.2 * PERIOD,
            "{} at {}",
            rig.state.stamp,
            rig.now()
        );
    }
}

#[test]
fn servos_are_configured_before_torque_is_enabled_and_disabled_at_the_end() {
    for protocol in PROTOCOLS {
        let rig = Rig::new(protocol);
        let registers = Registers::of(protocol);
        let counts = |rig: &Rig, register| -> Vec<i64> {
            let bus = rig.emulator.servos();
            bus.servos()
                .iter()
                .map(|servo| servo.get(register))
                .collect()
        };
        assert_eq!(counts(&rig, registers.torque), [1; 6]);
        assert_eq!(counts(&rig, registers.mode.expect("modes")), [1; 6]);
        assert_eq!(counts(&rig, registers.return_delay), [0; 6]);
        let limit = if protocol == Protocol::Dynamixel {
            650
        } else {
            100
        };
        let register = registers.current_limit.expect("a current limit");
        assert_eq!(counts(&rig, register), [limit; 6]);
        if let Some(watchdog) = registers.watchdog {
            assert_eq!(counts(&rig, watchdog), [5; 6]);
            // The watchdog was set before the torque.
            let bus = rig.emulator.servos();
            let writes = bus
                .log()
                .entries()
                .filter(|e| e.id == 1 && e.instruction == 3);
            let order: Vec<_> = writes.map(|e| (e.parameters[0], e.parameters[2])).collect();
            let at = |what: (u8, u8)| order.iter().rposition(|&w| w == what).expect("a write");
            assert!(at((98, 5)) < at((64, 1)), "{order:?}");
        }
        let Rig { hand, emulator, .. } = rig;
        drop(hand);
        emulator.wait(0.05);
        let torque: Vec<_> = emulator
            .servos()
            .servos()
            .iter()
            .map(|s| s.get(registers.torque))
            .collect();
        assert_eq!(torque, [0; 6]);
    }
}

/// Checks that a fault results in an error that names the servo and the cause, that all motors stand still afterwards,
/// and that no command is based on joint angles older than the limit.
fn stops(protocol: Protocol, fault: BusFault, words: &[&str]) {
    let mut rig = Rig::new(protocol);
    for _ in 0..10 {
        rig.period(0.02).unwrap();
    }
    let has_velocities = PROTOCOLS.contains(&protocol);
    assert!(!has_velocities || rig.goals().iter().any(|&goal| goal != 0.0));
    rig.emulator.inject(fault);
    let injected = rig.now();
    let error = (0..100).find_map(|_| rig.period(0.02).err());
    let error = error.unwrap_or_else(|| panic!("{fault:?} was not noticed"));
    let (error, noticed) = (error.to_string(), rig.now() - injected);
    for word in words {
        assert!(error.contains(word), "{fault:?}: no {word:?} in {error:?}");
    }
    assert!(
        noticed < within(protocol, fault),
        "{fault:?} was noticed after {noticed} s"
    );
    // If the stop command does not arrive, the watchdog stops the motor, if the servo has one.
    let through = !matches!(
        fault,
        BusFault::CablePulled | BusFault::FlipBytes(_) | BusFault::LoseBytes(_)
    );
    rig.emulator.wait(if through { 0.002 } else { 0.1 + 0.02 });
    let silent = |id: u8| matches!(fault, BusFault::Silent(silent) if silent == id);
    if through || protocol == Protocol::Dynamixel {
        let bus = rig.emulator.servos();
        for servo in bus.servos().iter().filter(|servo| !silent(servo.id)) {
            assert_eq!(servo.goal(), 0.0, "{fault:?}: servo {}", servo.id);
        }
    }
    let commands = |rig: &Rig| match has_velocities {
        true => ages_of_commands(&rig.emulator.servos(), protocol),
        false => ages_of_goal_positions(&rig.emulator.servos(), protocol),
    };
    let stopped = commands(&rig);
    for (time, age) in &stopped {
        assert!(*age <= MAX_AGE + 1e-3, "{fault:?}: {age} s old at {time} s");
    }
    // The hand rejects further commands.
    assert!(rig.period(0.02).is_err());
    rig.settle();
    let told = commands(&rig).len();
    assert_eq!(told, stopped.len(), "{fault:?}: commanded to move again");
    assert_eq!(rig.hand.fault(), Some(error.as_str()));
}

/// Maximum time until a fault is detected, s.
fn within(protocol: Protocol, fault: BusFault) -> f64 {
    // In the next period, at the latest by a response timeout: 4 ms plus the transmission time of six servos.
    let a_period = PERIOD + 0.006;
    match (protocol, fault) {
        // One of the six servos reports its health every 20 ms.
        (Protocol::Dynamixel, BusFault::Overheat(_) | BusFault::Undervoltage(_)) => {
            6.0 * 0.02 + a_period
        }
        // At random: 1 % of about 100 bytes per period.
        (_, BusFault::FlipBytes(_) | BusFault::LoseBytes(_)) => 20.0 * PERIOD,
        _ => a_period,
    }
}

#[test]
fn a_failed_servo_stops_the_hand() {
    for protocol in Protocol::ALL {
        stops(
            protocol,
            BusFault::Silent(5),
            &["theta2 of finger 1", "servo 5"],
        );
        stops(
            protocol,
            BusFault::Overheat(4),
            &["servo 4", "95 degrees", "temperature_limit_celsius"],
        );
        stops(
            protocol,
            BusFault::Undervoltage(2),
            &["servo 2", "3.1 V", "voltage_range"],
        );
        stops(
            protocol,
            BusFault::Hardware(6, 0x20),
            &["servo 6 (theta3 of finger 1)", "overload"],
        );
    }
    // The position of a Feetech servo wraps with every turn, so a jump of two turns has no effect.
    stops(
        Protocol::Dynamixel,
        BusFault::Jump(3),
        &["servo 3 (theta3 of finger 0)", "rad: expected"],
    );
}

/// A restarting servo is silent for 0.3 s, which is detected at once.
#[test]
fn a_restarting_servo_stops_the_hand() {
    for protocol in Protocol::ALL {
        stops(protocol, BusFault::Reboot(1), &["servo 1"]);
    }
}

#[test]
fn a_failed_bus_stops_the_hand() {
    for protocol in Protocol::ALL {
        stops(protocol, BusFault::FlipBytes(0.01), &["servo"]);
        stops(protocol, BusFault::LoseBytes(0.01), &["servo"]);
        stops(protocol, BusFault::Echo, &["echoes", "without echo"]);
        stops(
            protocol,
            BusFault::Late(1.0),
            &["servo 1", "did not answer"],
        );
        stops(protocol, BusFault::CablePulled, &["port failed", "cable"]);
    }
}

/// On a busy computer, a response may arrive after a request to another servo was sent.
#[test]
fn a_late_response_is_not_attributed_to_the_next_servo() {
    for protocol in Protocol::ALL {
        let config = config(protocol, 1);
        let lockstep = bus(&config);
        let how = (config.protocol, config.baud_rate);
        let port = Box::new(lockstep.clone());
        let mut master = Bus::on(port, how, 0.010, lockstep.clock());
        lockstep.inject(BusFault::Late(0.015));
        let error = master.ping(1).unwrap_err().to_string();
        assert!(error.contains("servo 1 did not answer"), "{error}");
        lockstep.inject(BusFault::Late(0.0));
        master.ping(2).unwrap_or_else(|error| panic!("{error}"));
        // If only late responses arrive, the error reports them.
        lockstep.inject(BusFault::Late(0.015));
        master.ping(1).unwrap_err();
        let error = master.ping(2).unwrap_err().to_string();
        assert!(error.contains("bytes from servo 2"), "{error}");
        assert!(error.contains("from servo 1"), "{error}");
    }
}

/// A port on which servo 9 sends without pause.
struct Babbling;

impl Port for Babbling {
    fn discard_input(&mut self) -> io::Result<()> {
        Ok(())
    }

    fn send(&mut self, _: &[u8]) -> io::Result<()> {
        Ok(())
    }

    fn receive(&mut self, bytes: &mut [u8], _: f64) -> io::Result<usize> {
        let mut answer = Vec::new();
        let parameters = [0, 0, 0, 0];
        encode(Protocol::Dynamixel, (9, STATUS), &parameters, &mut answer)
            .expect("a packet within the limit");
        bytes[..answer.len()].copy_from_slice(&answer);
        Ok(answer.len())
    }
}

#[test]
fn a_servo_that_sends_without_pause_does_not_block() {
    let how = (Protocol::Dynamixel, 1_000_000);
    let mut master = Bus::on(Box::new(Babbling), how, 0.01, RigClock::real());
    let error = master.ping(1).unwrap_err().to_string();
    assert!(error.contains("from servo 9"), "{error}");
}

/// A command is rejected if its joint angles are too old.
#[test]
fn a_slow_computer_stops_the_hand() {
    let mut rig = Rig::new(Protocol::Dynamixel);
    rig.period(0.02).unwrap();
    rig.hand.read(&mut rig.state).unwrap();
    rig.refuse_stale_command(0.02);
    assert_eq!(rig.goals(), [0.0; 6]);
    // The operator restarts the hand.
    rig.hand.restart().unwrap();
    rig.period(0.02).unwrap();
    rig.settle();
    assert!(rig.goals().iter().any(|&goal| goal != 0.0));
}

/// A failed computer does not even send a stop command.
#[test]
fn the_watchdogs_stop_the_motors_if_the_computer_fails() {
    let mut rig = Rig::new(Protocol::Dynamixel);
    for _ in 0..5 {
        rig.period(0.1).unwrap();
    }
    assert!(
        rig.goals().iter().all(|&goal| goal != 0.0),
        "{:?}",
        rig.goals()
    );
    // The last command was sent one period ago.
    rig.emulator.wait(0.1 - 2.0 * PERIOD);
    assert!(rig.goals().iter().all(|&goal| goal != 0.0));
    rig.emulator.wait(2.0 * PERIOD);
    assert_eq!(rig.goals(), [0.0; 6]);
    // Later commands have no effect, because the servos report the watchdog.
    let mut periods = 0..20;
    let error = periods
        .find_map(|_| rig.period(0.1).err())
        .expect("an error");
    assert!(error.to_string().contains("bus watchdog"), "{error}");
    assert_eq!(rig.goals(), [0.0; 6]);
}

/// If the computer was blocked until the watchdog stopped the servo, the error names the watchdog as the cause, even if
/// the next jog has velocity zero.
#[test]
fn a_late_jog_reports_that_the_watchdog_stopped_it() {
    for last in [0.1, 0.0] {
        let mut rig = Rig::new(Protocol::Dynamixel);
        for _ in 0..5 {
            rig.hand.read(&mut rig.state).unwrap();
            rig.hand.jog(0, 1, 0.1).unwrap();
            rig.emulator.wait(PERIOD);
        }
        assert_eq!(rig.goals().iter().filter(|&&goal| goal != 0.0).count(), 1);
        rig.emulator.wait(0.1);
        rig.hand.read(&mut rig.state).unwrap();
        let error = rig.hand.jog(0, 1, last).unwrap_err().to_string();
        let (joint, why) = ("theta2 of finger 0", "received nothing for too long");
        assert!(error.contains(joint) && error.contains(why), "{error}");
        assert_eq!(rig.hand.fault(), Some(&*error));
        // The next jog is rejected too, although joint angles are still fresh.
        let error = rig.hand.jog(0, 1, 0.1).unwrap_err().to_string();
        assert!(
            error.contains("until it is restarted") && error.contains(why),
            "{error}"
        );
        assert_eq!(rig.goals(), [0.0; 6]);
    }
}

#[test]
fn invalid_configurations_are_rejected() {
    let refused = |change: &dyn Fn(&mut feeler_drives::config::DrivesConfig), words: &[&str]| {
        let mut config = config(Protocol::Dynamixel, 1);
        change(&mut config);
        let error = Rig::of(config).err().expect("an error").to_string();
        for word in words {
            assert!(error.contains(word), "no {word:?} in {error}");
        }
    };
    refused(
        &|c| c.finger[0].joint[1].id = 1,
        &["drives.finger[0].joint[1].id = 1", "no other joint"],
    );
    refused(
        &|c| c.bus_watchdog = 0.0,
        &["drives.bus_watchdog = 0", "0.02 to 2.54"],
    );
    refused(
        &|c| c.finger[0].joint[0].model = "AX-12".into(),
        &["AX-12", "XL330-M288"],
    );
    refused(
        &|c| c.finger[0].joint[0].direction = 0,
        &["direction = 0", "1 or -1"],
    );
    refused(
        &|c| c.finger[0].joint[2].gear_ratio = 30.0,
        &["servo 3 (theta3 of finger 0)", "joint_speed_limit"],
    );
    // Greater than the stall torque: it would limit nothing.
    refused(
        &|c| limit_torque(c, 100.0),
        &[
            "drives.finger[0].joint[0].torque_limit = 100",
            "at most 0.735",
            "1.47 A",
        ],
    );
    // The emulated servos allow 0.5 A.
    refused(
        &|c| limit_torque(c, 0.3),
        &[
            "servo 1 (theta1 of finger 0) allows at most 0.500 A",
            "0.600 A by torque_limit",
            "address 38",
        ],
    );
    refused(
        &|c| c.voltage_range = [11.0, 12.6],
        &["servo 1", "5.0 V", "11 to 12.6 V"],
    );
}

/// Limits the torque of servo 1 by a constant of 0.5 N m/A.
fn limit_torque(config: &mut DrivesConfig, limit: f64) {
    let joint = &mut config.finger[0].joint[0];
    joint.mode = Some(DriveMode::CurrentLimitedPosition);
    (joint.current_limit, joint.torque_limit) = (None, Some(limit));
    joint.torque = Some(TorqueCalibration {
        constant: 0.5,
        constant_error: 0.0,
        friction: 0.0,
        friction_error: 0.0,
    });
}

/// A Feetech servo has no velocity limit to read; its model turns at 3400 counts/s.
#[test]
fn a_joint_too_fast_for_a_feetech_servo_is_refused() {
    for mode in DriveMode::ALL {
        for gear_ratio in [2.7, 3.0, 10.0, 30.0] {
            let mut config = config_in(Protocol::Feetech, mode, 1);
            config.finger[0].joint[0].gear_ratio = gear_ratio;
            let error = Rig::of(config).err().expect("an error").to_string();
            let needed = format!("expected at least {:.3} rad/s", 2.0 * gear_ratio);
            assert!(
                error.contains("servo 1 (theta1 of finger 0) is limited to 5.216 rad/s")
                    && error.contains(&needed)
                    && error.contains("travel_per_turn"),
                "{error}"
            );
        }
    }
}

#[test]
fn unexpected_servos_are_reported() {
    let config = config(Protocol::Dynamixel, 1);
    let bus = bus(&config);
    let open = |change: &dyn Fn(&mut feeler_drives::config::DrivesConfig)| {
        let mut changed = config.clone();
        change(&mut changed);
        let opened = hand_on(&bus, &changed);
        opened.err().expect("an error").to_string()
    };
    let error = open(&|c| c.finger[0].joint[1].id = 9);
    assert!(
        error.contains("theta2 of finger 0: servo 9 did not answer"),
        "{error}"
    );
    let error = open(&|c| c.finger[0].joint[0].model = "XM430-W350".into());
    assert!(
        error.contains("servo 1 (theta1 of finger 0) reports model 1190: expected 1020"),
        "{error}"
    );
}

/// Fast sync reads require firmware 46 in this series.
#[test]
fn firmware_too_old_for_fast_sync_reads_is_reported() {
    let mut config = config(Protocol::Dynamixel, 1);
    let mut servos = EmulatorConfig::of(&config, 1);
    servos.servos[1].set_firmware(45);
    let open = |config: &feeler_drives::config::DrivesConfig| {
        let bus = Lockstep::new(&servos, plant(config));
        hand_on(&bus, config)
    };
    let error = open(&config).err().expect("an error").to_string();
    assert!(
        error.contains("servo 2 (theta2 of finger 0) has firmware 45: expected 46 or newer"),
        "{error}"
    );
    config.fast_sync_read = false;
    open(&config).expect("a hand");
}

#[test]
fn a_missing_port_is_reported() {
    let mut config = config(Protocol::Dynamixel, 1);
    config.port = "/dev/not-there".into();
    let opened = DriveHand::open(&config, &[finger()], MAX_AGE, RigClock::real());
    let error = opened.err().expect("an error").to_string();
    assert!(
        error.contains("/dev/not-there") && error.contains("serial port"),
        "{error}"
    );
}

/// Identical commands and faults result in identical packets at identical times.
#[test]
fn a_bus_in_lockstep_is_deterministic() {
    let said = || {
        let mut rig = Rig::new(Protocol::Dynamixel);
        for step in 0..50 {
            rig.period(0.001 * f64::from(step)).unwrap();
        }
        rig.emulator.inject(BusFault::FlipBytes(0.01));
        while rig.period(0.02).is_ok() {}
        let bus = rig.emulator.servos();
        bus.log().entries().cloned().collect::<Vec<_>>()
    };
    assert_eq!(said(), said());
}
