//! Random faults over a rig of real processes, and what must hold whatever they were.
//!
//! A seed gives a schedule: which programs are killed, frozen and started again, when somebody stops and resumes the
//! hand, how bad the network is, and when somebody says garbage. What came of it is read from the hand's record.
//! `FEELER_CAMPAIGN` says how many schedules are played (2 unless said otherwise), `FEELER_CAMPAIGN_SEED` from which
//! seed on. Each that fails is named by its seed, and none ends the campaign.

#![cfg(all(feature = "link", unix))]

#[path = "../support/program.rs"]
mod program;

#[path = "../../../feeler-link/tests/support/ports.rs"]
mod ports;

#[path = "../link/rig.rs"]
mod rig;

mod play;
mod schedule;

use schedule::Schedule;

fn number(variable: &str, default: u64) -> u64 {
    let said = std::env::var(variable).ok();
    said.map_or(default, |said| {
        said.parse()
            .unwrap_or_else(|_| panic!("{variable}: a number"))
    })
}

#[test]
fn whatever_fails_no_hand_moves_on_stale_data_or_after_a_stop() {
    let first = number("FEELER_CAMPAIGN_SEED", 0);
    let seeds = first..first + number("FEELER_CAMPAIGN", 2);
    let mut failed = Vec::new();
    for seed in seeds {
        match play::play(&Schedule::new(seed)) {
            Ok(told) => eprintln!("seed {seed}: {told}"),
            Err(violation) => {
                eprintln!("seed {seed}: VIOLATION: {violation}");
                failed.push(seed);
            }
        }
    }
    assert!(failed.is_empty(), "seeds {failed:?}");
}
