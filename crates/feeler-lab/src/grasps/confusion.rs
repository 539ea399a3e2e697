//! Confusion matrix of a slip detector.

/// Confusion matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Confusion {
    /// Number of true positives: detected slips.
    pub noticed: usize,
    /// Number of false negatives: missed slips.
    pub missed: usize,
    /// Number of false positives.
    pub false_alarms: usize,
    /// Number of true negatives.
    pub quiet: usize,
}

impl Confusion {
    /// Number of classified samples.
    pub fn count(self) -> usize {
        self.noticed + self.missed + self.false_alarms + self.quiet
    }

    /// Counts a sample with its label and its classification.
    pub fn add(&mut self, slip: bool, says_slip: bool) {
        *match (slip, says_slip) {
            (true, true) => &mut self.noticed,
            (true, false) => &mut self.missed,
            (false, true) => &mut self.false_alarms,
            (false, false) => &mut self.quiet,
        } += 1;
    }

    /// Fraction of true slips that are detected.
    pub fn recall(self) -> f64 {
        self.noticed as f64 / (self.noticed + self.missed) as f64
    }

    /// Fraction of detected slips that are true.
    pub fn precision(self) -> f64 {
        self.noticed as f64 / (self.noticed + self.false_alarms) as f64
    }

    /// Fraction of samples without slip that are classified as slip.
    pub fn false_alarm_rate(self) -> f64 {
        self.false_alarms as f64 / (self.false_alarms + self.quiet) as f64
    }
}

impl std::ops::Add for Confusion {
    type Output = Self;

    fn add(self, more: Self) -> Self {
        Self {
            noticed: self.noticed + more.noticed,
            missed: self.missed + more.missed,
            false_alarms: self.false_alarms + more.false_alarms,
            quiet: self.quiet + more.quiet,
        }
    }
}
