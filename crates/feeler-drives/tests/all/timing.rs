//! The time that a control period occupies the bus, computed and measured.

#![cfg(target_os = "linux")]

use crate::support::{PERIOD, Rig, config_in};
use feeler::check::Checker;
use feeler_drives::config::DrivesConfig;
use feeler_drives::packet::Protocol;
use feeler_drives::packet::instruction::SYNC_WRITE;
use feeler_drives::registers::DriveMode;

/// Longest time from the request of joint angles to the last byte of the period (s).
fn longest_period(config: DrivesConfig) -> f64 {
    let mut rig = Rig::of(config).unwrap_or_else(|error| panic!("{error}"));
    let periods = (0..40).map(|_| {
        let begin = rig.now();
        rig.period(0.05).unwrap();
        let bus = rig.emulator.servos();
        let written = bus.log().entries().filter(|e| e.instruction == SYNC_WRITE);
        let written = written.last().expect("a command").time;
        written.max(rig.now() - PERIOD) - begin
    });
    periods.fold(0.0, f64::max)
}

/// To within the 10 us of a stuffed byte per servo.
#[test]
fn the_computed_time_is_that_on_the_bus() {
    for protocol in Protocol::ALL {
        for &mode in DriveMode::supported(protocol) {
            for fast in [true, false] {
                let mut config = config_in(protocol, mode, 2);
                config.baud_rate = 1_000_000;
                config.fast_sync_read &= fast;
                let computed = config.bus_time();
                let measured = longest_period(config);
                assert!(
                    (-1e-9..61e-6).contains(&(measured - computed)),
                    "{protocol:?} {mode:?}: computed {computed} s, measured {measured} s"
                );
            }
        }
    }
}

#[test]
fn a_bus_that_needs_more_than_a_period_is_refused() {
    // 24 bytes per servo to read, 24 to write all, 15 for the health.
    let seconds = |baud_rate: f64| (6.0 * 24.0 + 26.0 + 15.0) * 10.0 / baud_rate;
    for (baud_rate, good) in [(1_000_000, true), (200_000, true), (115_200, false)] {
        let mut config = config_in(Protocol::FeetechScs, DriveMode::Position, 2);
        config.baud_rate = baud_rate;
        let mut checker = Checker::default();
        config.check_period("drives", PERIOD, &mut checker);
        let expected = seconds(f64::from(baud_rate));
        assert!((config.bus_time() - expected).abs() < 1e-12, "{baud_rate}");
        match checker.finish() {
            Ok(()) => assert!(good, "{baud_rate}"),
            Err(problems) => {
                let problem = problems[0].to_string();
                assert!(!good, "{problem}");
                for word in [
                    "drives.baud_rate = 115200",
                    "control.period = 0.01 s",
                    "0.016059 s",
                ] {
                    assert!(problem.contains(word), "no {word:?} in {problem}");
                }
            }
        }
    }
}
