//! A control period over the bus takes no memory.

#![cfg(target_os = "linux")]

mod support;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use feeler::glam::DVec3;
use feeler::hand::Hand;
use feeler_drives::packet::Protocol;
use support::{PERIOD, Rig};

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

#[test]
fn a_period_allocates_nothing() {
    for protocol in [Protocol::Dynamixel, Protocol::Feetech] {
        let mut rig = Rig::new(protocol);
        rig.command.relay(&[DVec3::splat(0.05); 2]);
        for _ in 0..20 {
            let (hand, state, command) = (&mut rig.hand, &mut rig.state, &rig.command);
            let done = assert_no_alloc(|| {
                let read = hand.read(state);
                read.and_then(|()| hand.command(command))
            });
            done.unwrap();
            std::thread::sleep(std::time::Duration::from_secs_f64(PERIOD));
        }
    }
}
