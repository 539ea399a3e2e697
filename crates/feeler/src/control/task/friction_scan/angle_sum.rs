//! Running statistics of angles.

/// Running mean and variance of angles.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AngleSum {
    count: u64,
    mean: f64,
    /// Sum of squared deviations from the mean (rad²).
    squares: f64,
}

impl AngleSum {
    /// Adds an angle (rad), using Welford's recurrence, which is numerically stable.
    pub fn add(&mut self, angle: f64) {
        self.count += 1;
        let from_mean = angle - self.mean;
        self.mean += from_mean / self.count as f64;
        self.squares += from_mean * (angle - self.mean);
    }

    /// Number of angles added.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Mean (rad); `None` without angles.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }

    /// Variance (rad²); `None` for fewer than two angles.
    pub fn variance(&self) -> Option<f64> {
        (self.count > 1).then(|| self.squares / (self.count - 1) as f64)
    }
}
