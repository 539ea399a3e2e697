//! A hand on a pseudo-terminal in slowed-down real time, so that a busy computer keeps up.

#![cfg(target_os = "linux")]

use crate::support::{config, finger, plant};
use feeler::hand::{Hand, HandCommand, HandState, JointVector};
use feeler_drives::RigClock;
use feeler_drives::bus::Bus;
use feeler_drives::emulator::{BusFault, Emulator, EmulatorConfig};
use feeler_drives::hand::DriveHand;
use feeler_drives::packet::Protocol;
use feeler_drives::registers::Registers;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

/// Seconds of the rig's time per real second.
const SPEED: f64 = 0.05;
/// Practically unlimited age of joint angles, s of the rig's time: one hour of real time.
const EVER: f64 = 180.0;

#[test]
fn a_hand_moves_on_a_pseudo_terminal_and_stops_if_the_cable_is_pulled() {
    for protocol in [Protocol::Dynamixel, Protocol::Feetech] {
        let mut config = config(protocol, 2);
        // Disable other reasons to stop the hand.
        config.reply_timeout = 1.0;
        if protocol == Protocol::Dynamixel {
            config.bus_watchdog = 2.54;
        }
        let clock = RigClock::at_speed(SPEED);
        let bus = EmulatorConfig::of(&config, 1);
        let emulator = Emulator::start(&bus, plant(&config), clock.clone()).expect("a terminal");
        config.port = emulator.path().into();
        let hand = DriveHand::open(&config, &[finger(), finger()], EVER, clock.clone());
        let mut hand = hand.unwrap_or_else(|error| panic!("{protocol:?}: {error}"));
        let (mut state, mut command) = (HandState::zero(2), HandCommand::stop(2));
        hand.read(&mut state).unwrap();
        let begin = state.clone();
        command.relay(&[JointVector::splat(3, 0.2); 2]);
        while state.stamp < begin.stamp + 0.05 {
            hand.command(&command).unwrap();
            hand.read(&mut state).unwrap();
        }
        // The servos lag by 0.01 s, and a count is 1.5 mrad.
        let least = 0.2 * (0.05 - 0.02) - 0.003;
        for (joints, begin) in state.joints.iter().zip(&begin.joints) {
            let turned = joints.position - begin.position;
            assert!(turned.min_element() > least, "{protocol:?}: {turned}");
        }
        emulator.inject(BusFault::CablePulled);
        let error = loop {
            if let Err(error) = hand.read(&mut state) {
                break error.to_string();
            }
        };
        assert!(error.contains("port failed"), "{error}");
        drop(hand);
        let torque = Registers::of(protocol).torque;
        let servos = emulator.servos().servos().to_vec();
        assert!(servos.iter().all(|servo| servo.get(torque) == 1));
    }
}

#[test]
fn a_closed_bus_can_be_reopened_while_processes_start() {
    let config = config(Protocol::Dynamixel, 1);
    let clock = RigClock::at_speed(SPEED);
    let bus = EmulatorConfig::of(&config, 1);
    let emulator = Emulator::start(&bus, plant(&config), clock.clone()).expect("a terminal");
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        // A new process inherits all open files until it executes its program.
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                let ended = Command::new("true").status();
                assert!(ended.expect("a process").success());
            }
        });
        let how = (Protocol::Dynamixel, config.baud_rate);
        let opened = (0..2000).try_for_each(|_| {
            Bus::open(emulator.path(), how, config.reply_timeout, clock.clone()).map(drop)
        });
        over.store(true, Ordering::Relaxed);
        opened.expect("a free bus");
    });
}
