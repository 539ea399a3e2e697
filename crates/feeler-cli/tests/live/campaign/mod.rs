//! Injects random faults into a rig of real processes, and checks the safety invariants.
//!
//! A seed generates a schedule: which programs are killed, frozen and restarted, when the hand is stopped and resumed,
//! how impaired the network is, and when a peer sends garbage. The result is read from the hand's recording.
//! `FEELER_CAMPAIGN` sets the number of schedules (default 2), `FEELER_CAMPAIGN_SEED` the first seed. Each failed
//! schedule is reported with its seed; the campaign then continues.

#![cfg(unix)]

mod play;
mod schedule;

use crate::how_many::how_many;
use schedule::Schedule;

#[test]
fn random_faults_cause_no_motion_on_stale_data_or_after_a_stop() {
    let first = how_many("FEELER_CAMPAIGN_SEED", 0);
    let seeds = first..first + how_many("FEELER_CAMPAIGN", 2);
    let mut failed = Vec::new();
    for seed in seeds {
        match play::play(&Schedule::new(seed as u64)) {
            Ok(told) => eprintln!("seed {seed}: {told}"),
            Err(violation) => {
                eprintln!("seed {seed}: VIOLATION: {violation}");
                failed.push(seed);
            }
        }
    }
    assert!(failed.is_empty(), "seeds {failed:?}");
}
