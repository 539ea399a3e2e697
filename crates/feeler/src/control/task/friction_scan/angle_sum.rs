//! Mean and variance of angles, one after the other.

/// Counts, sums and squares.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AngleSum {
    count: u64,
    mean: f64,
    /// Sum of squared distances from the mean, rad².
    squares: f64,
}

impl AngleSum {
    /// Takes in one more (Welford's recurrence, which loses no digits to large sums).
    pub fn add(&mut self, angle: f64) {
        self.count += 1;
        let from_mean = angle - self.mean;
        self.mean += from_mean / self.count as f64;
        self.squares += from_mean * (angle - self.mean);
    }

    /// How many there were.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean, rad; none of none.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }

    /// Their variance, rad²; none of fewer than two.
    pub fn variance(&self) -> Option<f64> {
        (self.count > 1).then(|| self.squares / (self.count - 1) as f64)
    }
}
