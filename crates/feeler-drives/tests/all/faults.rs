//! Hardware faults of servos in every mode, overloads, and adapters that deliver responses late.

#![cfg(target_os = "linux")]

use crate::support::{MAX_AGE, PERIOD, Rig, bus, config_in, finger, hand_on};
use feeler_drives::Port;
use feeler_drives::bus::Bus;
use feeler_drives::emulator::{BusFault, Lockstep};
use feeler_drives::hand::DriveHand;
use feeler_drives::packet::Protocol;
use feeler_drives::packet::instruction::SYNC_WRITE;
use feeler_drives::registers::{DriveMode, Registers};
use std::io;

/// Every fault bit stops the hand and is named.
#[test]
fn every_fault_bit_is_named() {
    let dynamixel = [
        (0x01, "input voltage"),
        (0x04, "overheating"),
        (0x08, "motor encoder"),
        (0x10, "electrical shock"),
        (0x20, "overload"),
        (0x24, "overheating, overload"),
        (0x80, "bit 7"),
    ];
    let feetech = [
        (0x01, "input voltage"),
        (0x02, "encoder"),
        (0x04, "overheating"),
        (0x08, "overcurrent"),
        (0x20, "overload"),
    ];
    for (protocol, bits) in [
        (Protocol::Dynamixel, &dynamixel[..]),
        (Protocol::Feetech, &feetech),
        (Protocol::FeetechScs, &feetech),
    ] {
        for &mode in DriveMode::supported(protocol) {
            for (bits, name) in bits {
                let mut rig = Rig::of(config_in(protocol, mode, 1)).unwrap();
                rig.period(0.1).unwrap();
                rig.emulator.inject(BusFault::Hardware(2, *bits));
                let error = (0..2)
                    .find_map(|_| rig.period(0.1).err())
                    .expect("an error");
                let (error, expected) = (error.to_string(), format!("fault: {name} ({bits:#04x})"));
                assert!(error.contains("servo 2"), "{error}");
                assert!(error.contains(&expected), "{expected}: {error}");
            }
        }
    }
}

/// A Dynamixel that has switched itself off on an overload is restarted with the hand; one with another fault is not.
#[test]
fn a_restart_restores_a_servo_after_an_overload_only() {
    for mode in DriveMode::ALL {
        let mut rig = Rig::of(config_in(Protocol::Dynamixel, mode, 1)).unwrap();
        let registers = Registers::of(Protocol::Dynamixel);
        rig.period(0.1).unwrap();
        rig.emulator.inject(BusFault::Hardware(1, 0x20));
        (0..2)
            .find_map(|_| rig.period(0.1).err())
            .expect("an error");
        let reboots = |rig: &Rig| {
            let bus = rig.emulator.servos();
            let entries = bus.log().entries();
            let ids = entries.filter(|entry| entry.instruction == 8);
            ids.map(|entry| entry.id).collect::<Vec<_>>()
        };
        assert_eq!(reboots(&rig), [0; 0]);
        rig.hand
            .restart()
            .unwrap_or_else(|error| panic!("{mode:?}: {error}"));
        assert_eq!(reboots(&rig), [1]);
        assert_eq!(rig.get(registers.fault), [0; 3]);
        assert_eq!(rig.get(registers.torque), [1; 3]);
        for _ in 0..10 {
            rig.period(0.1).unwrap();
        }
        rig.emulator.inject(BusFault::Hardware(1, 0x04));
        (0..2)
            .find_map(|_| rig.period(0.1).err())
            .expect("an error");
        let error = rig.hand.restart().unwrap_err().to_string();
        assert!(error.contains("overheating"), "{mode:?}: {error}");
        assert_eq!(reboots(&rig), [1]);
        assert_eq!(rig.get(registers.torque), [0; 3]);
    }
}

/// A load near the stall torque overloads a servo in velocity mode, which reports it by its alert bit and switches off.
#[test]
fn a_persistent_overload_stops_the_hand() {
    for protocol in [Protocol::Dynamixel, Protocol::Feetech] {
        let mut rig = Rig::of(config_in(protocol, DriveMode::Velocity, 1)).unwrap();
        let begin = rig.now();
        let stall_torque = rig.emulator.servos().servos()[0].model.stall.0;
        // Friction adds 2 %.
        rig.emulator.inject(BusFault::Load(1, 0.97 * stall_torque));
        let error = (0..300)
            .find_map(|_| rig.period(0.01).err())
            .expect("an error");
        assert!(
            error.to_string().contains("overload"),
            "{protocol:?}: {error}"
        );
        let waited = rig.now() - begin;
        assert!(
            (1.0..1.0 + 3.0 * PERIOD).contains(&waited),
            "{protocol:?}: {waited} s"
        );
        rig.emulator.inject(BusFault::Load(1, 0.0));
        rig.hand
            .restart()
            .unwrap_or_else(|error| panic!("{protocol:?}: {error}"));
        for _ in 0..10 {
            rig.period(0.1).unwrap();
        }
    }
}

/// Responses that arrive 16 ms late would make joint angles older than they appear.
#[test]
fn an_adapter_with_16_ms_latency_is_refused() {
    for protocol in Protocol::ALL {
        for &mode in DriveMode::supported(protocol) {
            // A timeout shorter than the latency, and a longer one.
            for (timeout, latency, refused) in [
                (0.01, 0.016, true),
                (0.05, 0.016, true),
                (0.01, 0.001, false),
                // More than a quarter of the maximum age for three exchanges.
                (0.01, 0.004, !protocol.has_sync_read()),
            ] {
                let mut config = config_in(protocol, mode, 1);
                config.reply_timeout = timeout;
                let lockstep = bus(&config);
                lockstep.inject(BusFault::Latency(latency));
                match (hand_on(&lockstep, &config), refused) {
                    (Ok(_), false) => {}
                    (Err(error), true) => {
                        let error = error.to_string();
                        let advice = "set its latency timer to 1 ms";
                        assert!(error.contains(advice), "{timeout}, {latency}: {error}");
                        let after = if latency > 0.01 {
                            "after 0.01"
                        } else {
                            "after 0.00"
                        };
                        assert!(error.contains(after), "{timeout}, {latency}: {error}");
                    }
                    (Err(error), false) => panic!("{timeout}, {latency}: {error}"),
                    (Ok(_), true) => panic!("{timeout}, {latency}: not refused"),
                }
                // Torque is off.
                lockstep.wait(0.3);
                let torque = Registers::of(protocol).torque;
                let servos = lockstep.servos().servos().to_vec();
                assert!(servos.iter().all(|servo| servo.get(torque) == 0));
            }
        }
    }
}

/// A missing servo is not blamed on the adapter.
#[test]
fn a_missing_servo_is_not_a_slow_adapter() {
    let config = config_in(Protocol::Dynamixel, DriveMode::Position, 1);
    let lockstep = bus(&config);
    lockstep.inject(BusFault::Silent(2));
    let error = hand_on(&lockstep, &config)
        .err()
        .expect("an error")
        .to_string();
    assert!(error.contains("servo 2 did not answer"), "{error}");
}

/// A new goal ends the overload of an SCS servo, so the hand does not write one before its restart: the servo pushes with
/// the fifth of its torque that its protection allows.
#[test]
fn an_overloaded_scs_servo_gets_no_goal_until_the_restart() {
    let mut config = config_in(Protocol::FeetechScs, DriveMode::Position, 1);
    config.finger[0].joint[0].leash = Some(0.6);
    let lockstep = bus(&config);
    let mut rig = Rig::on(lockstep, config).unwrap_or_else(|error| panic!("{error}"));
    let registers = Registers::of(Protocol::FeetechScs);
    // More than the servo can push, so that it stands still with all its current.
    rig.emulator.inject(BusFault::Load(1, 0.23));
    let error = (0..300).find_map(|_| rig.period(0.5).err());
    let error = error.expect("an overload").to_string();
    assert!(
        error.contains("servo 1") && error.contains("overload"),
        "{error}"
    );
    let goals = |rig: &Rig| {
        let bus = rig.emulator.servos();
        let writes = bus.log().entries().filter(|entry| {
            entry.instruction == SYNC_WRITE
                && u16::from(entry.parameters[0]) == registers.goal_position.address
        });
        let servos = writes.map(|write| write.parameters[2..].chunks(3).map(|goal| goal[0]));
        servos.flatten().filter(|&id| id == 1).count()
    };
    let before = goals(&rig);
    for _ in 0..20 {
        assert!(rig.command(0.0).is_err());
        rig.emulator.wait(PERIOD);
    }
    assert_eq!(goals(&rig), before);
    assert_eq!(rig.get(registers.fault)[0], 0x20);
    rig.emulator.inject(BusFault::Load(1, 0.0));
    rig.hand.restart().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(rig.get(registers.fault), [0; 3]);
    for _ in 0..10 {
        rig.period(0.1).unwrap();
    }
    assert!(goals(&rig) > before);
}

/// A port that fails once the torque of a servo has been switched on.
struct FailsWithTorque(Lockstep);

impl Port for FailsWithTorque {
    fn discard_input(&mut self) -> io::Result<()> {
        self.0.discard_input()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let torque = Registers::of(Protocol::Dynamixel).torque;
        let is_on = self.0.servos().servos().iter().any(|s| s.get(torque) != 0);
        match is_on {
            true => Err(io::ErrorKind::NotConnected.into()),
            false => self.0.send(bytes),
        }
    }

    fn receive(&mut self, bytes: &mut [u8], deadline: f64) -> io::Result<usize> {
        self.0.receive(bytes, deadline)
    }
}

#[test]
fn a_failed_start_warns_if_torque_may_be_on() {
    let protocol = Protocol::Dynamixel;
    let config = config_in(protocol, DriveMode::Velocity, 1);
    let lockstep = bus(&config);
    let port = Box::new(FailsWithTorque(lockstep.clone()));
    let how = (protocol, config.baud_rate);
    let master = Bus::on(port, how, config.reply_timeout, lockstep.clock());
    let error = DriveHand::on(master, &config, &[finger()], MAX_AGE)
        .err()
        .expect("an error")
        .to_string();
    assert!(error.contains("the serial port failed"), "{error}");
    assert!(error.contains("torque may still be enabled"), "{error}");

    // If a servo is silent, no torque is switched on, and the other servos confirm it.
    let lockstep = bus(&config);
    lockstep.inject(BusFault::Silent(3));
    let error = hand_on(&lockstep, &config).err().expect("an error");
    let error = error.to_string();
    assert!(
        error.contains("servo 3") && !error.contains("torque"),
        "{error}"
    );
}
