//! Random faults over a rig of real processes, and what must hold whatever they were.
//!
//! A seed gives a schedule: which programs are killed, frozen and started again, when somebody stops and resumes the
//! hand, how bad the network is, and when somebody says garbage. What came of it is read from the hand's record.
//! `FEELER_CAMPAIGN` says how many schedules are played (2 unless said otherwise), `FEELER_CAMPAIGN_SEED` from which
//! seed on. Each that fails is named by its seed, and none ends the campaign.

#![cfg(unix)]

mod play;
mod schedule;

use crate::how_many::how_many;
use schedule::Schedule;

#[test]
fn whatever_fails_no_hand_moves_on_stale_data_or_after_a_stop() {
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
