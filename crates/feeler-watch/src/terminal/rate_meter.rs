//! Rate and loss of numbered messages.

/// Measures the rate and loss of numbered messages.
#[derive(Debug, Clone, Default)]
pub struct RateMeter {
    newest: Option<u64>,
    received: u64,
    lost: u64,
    /// Start time (s) of the current rate measurement, and the number of messages received before it.
    begun: Option<(f64, u64)>,
    rate: Option<f64>,
}

impl RateMeter {
    /// Duration of a rate measurement (s).
    const DURATION: f64 = 0.5;

    /// Registers that `sequence` is the latest message at `now` (s). May be called repeatedly for the same message.
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
        // Slightly shorter, so that rounding of times does not extend the measurement by a step.
        if now - begun > Self::DURATION * 0.9999 {
            self.rate = Some((self.received - before) as f64 / (now - begun));
            self.begun = Some((now, self.received));
        }
    }

    /// Registers one more message at `now` (s).
    pub fn next(&mut self, now: f64) {
        self.newest(self.newest.map_or(0, |newest| newest + 1), now);
    }

    /// Message rate (Hz), or NaN before the first measurement.
    pub fn rate(&self) -> f64 {
        self.rate.unwrap_or(f64::NAN)
    }

    /// Number of messages received.
    pub fn received(&self) -> u64 {
        self.received
    }

    /// Number of messages missing between the first and the latest.
    pub fn lost(&self) -> u64 {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_rate_and_loss() {
        let mut arrivals = RateMeter::default();
        assert!(arrivals.rate().is_nan());
        // Every fourth message is lost; the newest one is registered repeatedly.
        for step in 0..=200_u64 {
            let sequence = if step % 4 == 3 { step - 1 } else { step };
            arrivals.newest(7 + sequence, 0.01 * step as f64);
        }
        assert_eq!((arrivals.received(), arrivals.lost()), (151, 50));
        // A measurement spans 50 steps and receives 37 or 38 messages.
        assert!((arrivals.rate() - 75.0).abs() <= 1.0, "{}", arrivals.rate());
    }

    #[test]
    fn consecutive_messages_are_not_lost() {
        let mut arrivals = RateMeter::default();
        for step in 0..=100 {
            arrivals.next(0.01 * f64::from(step));
        }
        assert_eq!((arrivals.received(), arrivals.lost()), (101, 0));
        assert!((arrivals.rate() - 100.0).abs() < 1e-6);
    }
}
