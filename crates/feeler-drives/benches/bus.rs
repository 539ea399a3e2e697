//! Measures the delay from the stamp of joint angles to the command on the emulated bus at 4 Mbaud, and the time that a
//! control period of six servos occupies the bus at 1 Mbaud in each mode.
//!
//! Not a divan benchmark, because a second thread is involved. Prints percentiles for two and three fingers.

#[cfg(target_os = "linux")]
#[path = "../tests/support/mod.rs"]
mod support;

#[cfg(not(target_os = "linux"))]
fn main() {}

/// Prints the longest time from the request of joint angles to the last byte of the command, with the health check, at
/// 1 Mbaud. In lockstep, so the computer takes no time.
#[cfg(target_os = "linux")]
fn print_periods() {
    use feeler_drives::packet::Protocol;
    use feeler_drives::packet::instruction::SYNC_WRITE;
    use feeler_drives::registers::DriveMode;

    for protocol in Protocol::ALL {
        for &mode in DriveMode::supported(protocol) {
            for fast in [true, false] {
                let mut config = support::config_in(protocol, mode, 2);
                config.baud_rate = 1_000_000;
                config.fast_sync_read &= fast;
                if fast && !config.fast_sync_read {
                    continue;
                }
                let mut rig = support::Rig::of(config).unwrap_or_else(|error| panic!("{error}"));
                let mut longest: f64 = 0.0;
                for _ in 0..100 {
                    let begin = rig.now();
                    rig.period(0.05).expect("a period");
                    let bus = rig.emulator.servos();
                    let written = bus.log().entries().filter(|e| e.instruction == SYNC_WRITE);
                    let end = written.last().map_or(0.0, |entry| entry.time);
                    drop(bus);
                    longest = longest
                        .max(end - begin)
                        .max(rig.now() - support::PERIOD - begin);
                }
                let read = match (protocol.has_sync_read(), fast) {
                    (false, _) => "one by one",
                    (true, true) => "fast sync read",
                    (true, false) => "plain sync read",
                };
                println!(
                    "{protocol:?}, {}, {read}: six servos at 1 Mbaud, at most {:.3} ms per period",
                    mode.name(),
                    longest * 1e3,
                );
            }
        }
    }
}

#[cfg(target_os = "linux")]
fn main() {
    use feeler::hand::{Hand, HandCommand, HandState, JointVector};
    use feeler::pace::FixedRate;
    use feeler_drives::RigClock;
    use feeler_drives::emulator::{Emulator, EmulatorConfig};
    use feeler_drives::hand::DriveHand;
    use feeler_drives::packet::Protocol;
    use feeler_drives::packet::instruction::SYNC_WRITE;

    print_periods();
    for (fingers, rate) in [(2, 100.0), (2, 500.0), (3, 100.0), (3, 500.0)] {
        let mut config = support::config(Protocol::Dynamixel, fingers);
        config.reply_timeout = 0.5;
        let clock = RigClock::real();
        let bus = EmulatorConfig::of(&config, 1);
        let emulator =
            Emulator::start(&bus, support::plant(&config), clock.clone()).expect("a terminal");
        config.port = emulator.path().into();
        let geometry = vec![support::finger(); fingers];
        let hand = DriveHand::open(&config, &geometry, support::MAX_AGE, clock);
        let mut hand = hand.unwrap_or_else(|error| panic!("{error}"));
        let (mut state, mut command) = (HandState::zero(fingers), HandCommand::stop(fingers));
        let mut pace = FixedRate::new(1.0 / rate).expect("a period");
        let mut stamps = Vec::new();
        let begin = emulator.servos().log().entries().count();
        for step in 0..(3.0 * rate) as u32 {
            pace.wait();
            hand.read(&mut state).expect("joint angles");
            stamps.push(state.stamp);
            let velocity = if step % 2 == 0 { 0.05 } else { -0.05 };
            command.relay(&vec![JointVector::splat(3, velocity); fingers]);
            hand.command(&command).expect("a command");
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
        let bus = emulator.servos();
        let entries = bus.log().entries().skip(begin);
        let written = entries.filter(|entry| entry.instruction == SYNC_WRITE);
        let mut delays: Vec<f64> = written.zip(&stamps).map(|(w, s)| w.time - s).collect();
        delays.sort_by(f64::total_cmp);
        let at = |share: f64| delays[((delays.len() - 1) as f64 * share) as usize] * 1e3;
        println!(
            "{fingers} fingers, {rate} Hz: joint angles to the command's last byte on the bus, {} periods: p50 {:.3} ms, p99 {:.3} ms, max {:.3} ms",
            delays.len(),
            at(0.5),
            at(0.99),
            at(1.0),
        );
    }
}
