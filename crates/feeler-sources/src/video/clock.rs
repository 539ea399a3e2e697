//! Frame numbers for a camera whose own are not to be had: a late frame leaves a gap.

/// Numbers frames by when they arrive.
#[derive(Debug)]
pub(super) struct FrameClock {
    interval: f64,
    last: Option<(u64, f64)>,
}

impl FrameClock {
    /// Numbers frames that are `interval` seconds apart.
    pub(super) fn new(interval: f64) -> Self {
        Self {
            interval,
            last: None,
        }
    }

    /// The number of a frame that arrives at `stamp`, s.
    pub(super) fn sequence(&mut self, stamp: f64) -> u64 {
        let sequence = self.last.map_or(0, |(sequence, before)| {
            let intervals = ((stamp - before) / self.interval).round();
            // A cast saturates: an interval of 0 s or none at all gives the next number.
            sequence.saturating_add((intervals as u64).clamp(1, u64::from(u32::MAX)))
        });
        self.last = Some((sequence, stamp));
        sequence
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_frame_leaves_a_gap() {
        let mut clock = FrameClock::new(0.01);
        let stamps = [0.5, 0.51, 0.5198, 0.5502, 0.5502];
        assert_eq!(stamps.map(|stamp| clock.sequence(stamp)), [0, 1, 2, 5, 6]);
        let mut stopped = FrameClock::new(0.0);
        assert_eq!([0.0, 0.0].map(|stamp| stopped.sequence(stamp)), [0, 1]);
    }
}
