//! Servos of Feetech's SCS series: settings that they do not support, and reading one servo after the other.

#![cfg(target_os = "linux")]

use crate::support::{PERIOD, Rig, bus, config, config_in, hand_on, master};
use feeler::hand::Hand;
use feeler_drives::Port;
use feeler_drives::config::{DrivesConfig, TorqueCalibration};
use feeler_drives::emulator::BusFault;
use feeler_drives::packet::instruction::{READ, SYNC_READ};
use feeler_drives::packet::{BROADCAST, Protocol, Sender, encode};
use feeler_drives::registers::{DriveMode, Registers};

/// Bytes of a read of 10 bytes and its response, and time of their transmission at 1 Mbaud (s).
const EXCHANGE: f64 = (8.0 + 16.0) * 1e-5;

#[test]
fn settings_without_support_are_refused() {
    let refused = |change: &dyn Fn(&mut DrivesConfig), expected: &str| {
        let mut config = config(Protocol::FeetechScs, 1);
        change(&mut config);
        let error = hand_on(&bus(&config), &config).err().expect("an error");
        assert_eq!(error.to_string(), expected);
    };
    for (mode, name) in [(None, "velocity"), (Some(DriveMode::Velocity), "velocity")] {
        refused(
            &|c| c.finger[0].joint[1].mode = mode,
            &format!(
                "drives.finger[0].joint[1].mode = \"{name}\": expected \"position\", the only mode of SCS servos"
            ),
        );
    }
    refused(
        &|c| c.finger[0].joint[0].current_limit = Some(0.5),
        "drives.finger[0].joint[0].current_limit = 0.5: expected no value: SCS servos measure no current",
    );
    let torque = TorqueCalibration {
        constant: 0.5,
        constant_error: 0.0,
        friction: 0.0,
        friction_error: 0.0,
    };
    refused(
        &|c| c.finger[0].joint[0].torque = Some(torque),
        "drives.finger[0].joint[0].torque = a calibration: expected no value: SCS servos measure no current",
    );
    refused(
        &|c| c.bus_watchdog = 0.1,
        "drives.bus_watchdog = 0.1: expected 0: Feetech servos have no watchdog, so their motors keep running if the computer fails",
    );
    refused(
        &|c| c.fast_sync_read = true,
        "drives.fast_sync_read = true: expected false: Feetech servos do not support fast sync reads",
    );
    // The other series would take each value for one with swapped bytes.
    refused(
        &|c| c.finger[0].joint[2].model = "STS3215".into(),
        "drives.finger[0].joint[2].model = \"STS3215\": expected one of SCS0009 for protocol = \"feetech-scs\"",
    );
    let mut mixed = config(Protocol::Feetech, 1);
    mixed.finger[0].joint[0].model = "SCS0009".into();
    let error = hand_on(&bus(&mixed), &mixed).err().expect("an error");
    assert_eq!(
        error.to_string(),
        "drives.finger[0].joint[0].model = \"SCS0009\": expected one of STS3215 for protocol = \"feetech\""
    );
}

/// The vendor's SDK does not support sync reads of this series.
#[test]
fn a_sync_read_gets_no_answer() {
    let config = config(Protocol::FeetechScs, 1);
    let emulator = bus(&config);
    for (code, answers) in [(SYNC_READ, 0), (READ, 1)] {
        let (id, parameters) = match code {
            READ => (1, vec![56, 10]),
            _ => (BROADCAST, vec![56, 10, 1, 2, 3]),
        };
        let mut bytes = Vec::new();
        encode(config.protocol, (id, code), &parameters, &mut bytes).expect("a packet");
        emulator.clone().send(&bytes).expect("a connected port");
        emulator.wait(0.01);
        let sent = emulator.servos().take_log();
        let sent = sent.iter().filter(|entry| entry.sender == Sender::Servo);
        assert_eq!(sent.count(), answers, "{code:#x}");
    }
    let mut master = master(&emulator, &config);
    assert_eq!(
        master
            .read(1, Registers::of(config.protocol).model)
            .unwrap(),
        1284
    );
}

/// The stamp is that of the first response, as the joint angles in it are the oldest.
#[test]
fn servos_are_read_one_after_the_other_and_stamped_by_the_first() {
    let mut rig = Rig::new(Protocol::FeetechScs);
    rig.period(0.0).unwrap();
    let begin = rig.now();
    rig.hand.read(&mut rig.state).unwrap();
    assert!(
        (rig.state.stamp - begin - EXCHANGE).abs() < 1e-9,
        "{} s",
        rig.state.stamp - begin
    );
    assert!((rig.now() - begin - 6.0 * EXCHANGE).abs() < 1e-9);
    let log = rig.emulator.servos().take_log();
    assert!(log.iter().all(|entry| entry.instruction != SYNC_READ));
}

/// Delays of up to 2 ms are allowed for three servos but not for nine: the limit is a quarter of 35 ms for all of them.
#[test]
fn the_delay_of_the_adapter_counts_once_per_servo() {
    for (fingers, good) in [(1, true), (3, false)] {
        let mut config = config_in(Protocol::FeetechScs, DriveMode::Position, fingers);
        config.reply_timeout = 0.01;
        let emulator = bus(&config);
        emulator.inject(BusFault::Latency(0.002));
        match hand_on(&emulator, &config) {
            Ok(_) => assert!(good, "{fingers} fingers"),
            Err(error) => {
                assert!(!good, "{error}");
                assert!(error.to_string().contains("latency timer"), "{error}");
            }
        }
    }
}

/// A servo that falls silent is named, and stops the hand within a period.
#[test]
fn a_silent_servo_is_named() {
    let mut rig = Rig::new(Protocol::FeetechScs);
    rig.period(0.1).unwrap();
    rig.emulator.inject(BusFault::Silent(4));
    let begin = rig.now();
    let error = rig.period(0.1).unwrap_err().to_string();
    assert!(
        error.contains("theta1 of finger 1: servo 4 did not answer"),
        "{error}"
    );
    assert!(rig.now() - begin < PERIOD);
}
