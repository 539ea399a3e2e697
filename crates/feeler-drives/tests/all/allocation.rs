//! Control periods on the bus do not allocate.

#![cfg(target_os = "linux")]

use crate::support::{MAX_AGE, PERIOD, bus, config_in, finger, share};
use assert_no_alloc::{assert_no_alloc, permit_alloc};
use feeler::hand::{Hand, HandCommand, HandState, JointVector};
use feeler_drives::Port;
use feeler_drives::bus::Bus;
use feeler_drives::emulator::Lockstep;
use feeler_drives::hand::DriveHand;
use feeler_drives::packet::Protocol;
use feeler_drives::packet::instruction::READ;
use feeler_drives::registers::DriveMode;
use std::io;

/// Port of an emulated bus. The emulator may allocate, because real servos are not part of this process.
struct Elsewhere(Lockstep);

impl Port for Elsewhere {
    fn discard_input(&mut self) -> io::Result<()> {
        permit_alloc(|| self.0.discard_input())
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        permit_alloc(|| self.0.send(bytes))
    }

    fn receive(&mut self, bytes: &mut [u8], deadline: f64) -> io::Result<usize> {
        permit_alloc(|| self.0.receive(bytes, deadline))
    }
}

/// Every period includes a health check, and each servo is checked several times.
#[test]
fn a_period_does_not_allocate() {
    for protocol in Protocol::ALL {
        let modes = DriveMode::supported(protocol).iter();
        let variants = modes.flat_map(|&mode| [(true, mode, false), (false, mode, true)]);
        for (fast, mode, shared) in variants {
            let mut config = config_in(protocol, mode, 2);
            if shared {
                config = share(config);
            }
            config.health_interval = 0.001;
            config.fast_sync_read &= fast;
            let bus = bus(&config);
            let how = (protocol, config.baud_rate);
            let port = Box::new(Elsewhere(bus.clone()));
            let master = Bus::on(port, how, config.reply_timeout, bus.clock());
            let hand = DriveHand::on(master, &config, &[finger(), finger()], MAX_AGE);
            let mut hand = hand.unwrap_or_else(|error| panic!("{error}"));
            let (mut state, mut command) = (HandState::zero(2), HandCommand::stop(2));
            command.relay(&[JointVector::splat(3, 0.05); 2]);
            let asked = || {
                let bus = bus.servos();
                let reads = bus.log().entries().filter(|e| e.instruction == READ);
                reads.count()
            };
            // The first health check is due.
            bus.wait(PERIOD);
            let before = asked();
            for _ in 0..20 {
                let done = assert_no_alloc(|| {
                    hand.read(&mut state)?;
                    hand.command(&command)
                });
                done.unwrap();
                bus.wait(PERIOD);
            }
            // SCS servos are also read one by one.
            let read = match protocol.has_sync_read() {
                true => 0,
                false => 20 * config.servos().count(),
            };
            assert!(asked() >= before + read + 20, "no health was read");
        }
    }
}
