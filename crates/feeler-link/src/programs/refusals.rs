//! Which programs are refused, each told once.

use crate::mismatch::Mismatch;
use crate::peers::Peers;
use std::collections::HashSet;

/// Remembers which refused programs have been reported, by their instances.
#[derive(Debug, Default)]
pub(super) struct Refusals(HashSet<u64>);

impl Refusals {
    /// Why those of `peers` are refused that have not been reported.
    pub fn new_ones(&mut self, peers: &Peers) -> Vec<Mismatch> {
        let refused = peers.all().iter().filter_map(|peer| {
            let mismatch = peer.refused.clone()?;
            let is_new = self.0.insert(peer.heartbeat.instance);
            is_new.then_some(mismatch)
        });
        refused.collect()
    }
}
