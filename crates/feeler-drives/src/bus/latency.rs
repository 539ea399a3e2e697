//! Delays of responses, for the detection of slow adapters.

/// Number of delays that are stored.
const RECENT: usize = 15;

/// Delays of the most recent responses, in a buffer of fixed size.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Latency {
    delays: [f64; RECENT],
    count: usize,
}

impl Latency {
    /// Adds the delay of a response, s.
    pub fn add(&mut self, delay: f64) {
        self.delays[self.count % RECENT] = delay;
        self.count += 1;
    }

    /// Median delay, s; 0 before the first response.
    pub fn median(&self) -> f64 {
        let mut sorted = self.delays;
        let recent = &mut sorted[..self.count.min(RECENT)];
        recent.sort_unstable_by(f64::total_cmp);
        recent.get(recent.len() / 2).copied().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_delay_does_not_change_the_median() {
        let mut latency = Latency::default();
        assert_eq!(latency.median(), 0.0);
        for delay in [0.0, 0.001, 0.5] {
            latency.add(delay);
        }
        assert_eq!(latency.median(), 0.001);
        for _ in 0..20 {
            latency.add(0.016);
        }
        assert_eq!(latency.median(), 0.016);
    }
}
