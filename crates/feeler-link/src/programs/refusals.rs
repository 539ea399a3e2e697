//! Rate-limited reporting of refused programs.

use crate::inboxes::peers::Peers;
use crate::messages::mismatch::Mismatch;
use std::collections::VecDeque;

/// Number of reported refusals that are remembered to avoid repetitions, and maximum number of reports at once.
const MOST: usize = 64;

/// Maximum average number of reports per second, which protects the log from a flood of new programs.
const RATE: f64 = 1.0;

/// Filter that reports each refusal once.
#[derive(Debug)]
pub(super) struct Refusals {
    told: VecDeque<Mismatch>,
    /// Number of reports still allowed at the time `at` (s).
    allowed: f64,
    at: f64,
}

impl Default for Refusals {
    fn default() -> Self {
        Self {
            told: VecDeque::with_capacity(MOST),
            allowed: MOST as f64,
            at: 0.0,
        }
    }
}

impl Refusals {
    /// Returns the refusals in `peers` that have not been reported, as far as the rate at `now` (s) allows.
    pub fn new_ones(&mut self, peers: &Peers, now: f64) -> Vec<Mismatch> {
        self.allowed = (self.allowed + RATE * (now - self.at)).min(MOST as f64);
        self.at = now;
        let mut new = Vec::new();
        for mismatch in peers.all().iter().filter_map(|peer| peer.refused.as_ref()) {
            if self.allowed < 1.0 || self.told.contains(mismatch) {
                continue;
            }
            if self.told.len() == MOST {
                self.told.pop_front();
            }
            self.told.push_back(mismatch.clone());
            self.allowed -= 1.0;
            new.push(mismatch.clone());
        }
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inboxes::peers::Expected;
    use crate::messages::message::{Heartbeat, NO_FINGER, PROTOCOL, ProgramKind};
    use crate::transport::outlet::encode;

    /// Adds a rig program with another experiment.
    fn refuse(peers: &mut Peers, instance: u64, experiment: &str, now: f64) {
        let heartbeat = Heartbeat {
            protocol: PROTOCOL,
            instance,
            program: ProgramKind::World,
            finger: NO_FINGER,
            experiment: experiment.into(),
            ..Heartbeat::default()
        };
        let place = heartbeat.place().unwrap();
        let bytes = encode(&heartbeat).unwrap();
        peers.heard(place, &bytes, now).unwrap();
    }

    #[test]
    fn refusals_are_reported_once_and_rate_limited() {
        let mut peers = Peers::new(Expected::default());
        let mut refusals = Refusals::default();
        refuse(&mut peers, 1, "theirs", 0.0);
        assert_eq!(refusals.new_ones(&peers, 0.0).len(), 1);
        refuse(&mut peers, 2, "theirs", 0.1);
        assert_eq!(refusals.new_ones(&peers, 0.1), []);
        let mut told = 0;
        for instance in 3..10_003 {
            let now = 0.001 * instance as f64;
            refuse(&mut peers, instance, &instance.to_string(), now);
            told += refusals.new_ones(&peers, now).len();
        }
        assert!((MOST..MOST + 20).contains(&told), "{told}");
        assert!(refusals.told.len() <= MOST);
    }
}
