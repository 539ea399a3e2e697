//! How often something comes, and how much of it does not.

/// Counts numbered messages and measures their rate.
#[derive(Debug, Clone, Default)]
pub struct Arrivals {
    newest: Option<u64>,
    received: u64,
    lost: u64,
    /// When the measurement of the rate under way began, s, and what had been received then.
    begun: Option<(f64, u64)>,
    rate: Option<f64>,
}

impl Arrivals {
    /// A measurement of the rate takes this long, s.
    const DURATION: f64 = 0.5;

    /// At `now` (s), the newest message is the one of number `sequence`, again or for the first time.
    pub fn newest(&mut self, sequence: u64, now: f64) {
        if self.newest != Some(sequence) {
            let skipped = self
                .newest
                .map_or(0, |newest| sequence.saturating_sub(newest + 1));
            self.lost += skipped;
            self.received += 1;
            self.newest = Some(sequence);
        }
        let &mut (begun, before) = self.begun.get_or_insert((now, self.received));
        // A little less, so that the rounding of times makes it no step longer.
        if now - begun > Self::DURATION * 0.9999 {
            self.rate = Some((self.received - before) as f64 / (now - begun));
            self.begun = Some((now, self.received));
        }
    }

    /// At `now` (s), the next message has come.
    pub fn next(&mut self, now: f64) {
        self.newest(self.newest.map_or(0, |newest| newest + 1), now);
    }

    /// How often they come, Hz; not a number before that was measured.
    pub fn rate(&self) -> f64 {
        self.rate.unwrap_or(f64::NAN)
    }

    /// Those that came.
    pub fn received(&self) -> u64 {
        self.received
    }

    /// Those between the first and the newest that did not.
    pub fn lost(&self) -> u64 {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rate_and_loss_are_those_of_the_numbers() {
        let mut arrivals = Arrivals::default();
        assert!(arrivals.rate().is_nan());
        // Every fourth is lost; one looks again and again meanwhile.
        for step in 0..=200_u64 {
            let sequence = if step % 4 == 3 { step - 1 } else { step };
            arrivals.newest(7 + sequence, 0.01 * step as f64);
        }
        assert_eq!((arrivals.received(), arrivals.lost()), (151, 50));
        // A measurement of 50 steps has 37 or 38 of them.
        assert!((arrivals.rate() - 75.0).abs() <= 1.0, "{}", arrivals.rate());
    }

    #[test]
    fn counting_on_loses_nothing() {
        let mut arrivals = Arrivals::default();
        for step in 0..=100 {
            arrivals.next(0.01 * f64::from(step));
        }
        assert_eq!((arrivals.received(), arrivals.lost()), (101, 0));
        assert!((arrivals.rate() - 100.0).abs() < 1e-6);
    }
}
