//! How punctual the steps were.

use super::error::PaceError;
use super::timer::Tick;
use hdrhistogram::Histogram;
use std::fmt;

/// Lateness is told apart from 1 ns to an hour, in ns.
const LONGEST: u64 = 3_600_000_000_000;

/// Digits to which percentiles are kept: 1 %, for 40 kB.
const DIGITS: u8 = 2;

/// Gathers ticks in a fixed amount of memory, all of it taken when it is made.
#[derive(Clone, Debug)]
pub struct Punctuality {
    /// Lateness, ns.
    histogram: Histogram<u64>,
    /// s.
    largest: f64,
    missed: u64,
    overruns: u64,
}

/// What ticks had in common. Lateness is in s, and none before the first tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PunctualitySummary {
    /// Steps that were begun. Those that were missed are not among them.
    pub steps: u64,
    /// Periods that went by whole without a step.
    pub missed: u64,
    /// Steps that began late because the step before took too long.
    pub overruns: u64,
    /// Lateness that half of the steps did not exceed, to 1 %.
    pub median: Option<f64>,
    /// Lateness that 99 % of the steps did not exceed, to 1 %.
    pub percentile_99: Option<f64>,
    /// The largest lateness.
    pub largest: Option<f64>,
}

impl Punctuality {
    /// Without any ticks yet.
    ///
    /// # Errors
    /// When the histogram cannot be made.
    pub fn new() -> Result<Self, PaceError> {
        Ok(Self {
            histogram: Histogram::new_with_bounds(1, LONGEST, DIGITS)?,
            largest: 0.0,
            missed: 0,
            overruns: 0,
        })
    }

    /// Counts a tick in.
    pub fn record(&mut self, tick: &Tick) {
        self.histogram
            .saturating_record((tick.lateness * 1e9).round() as u64);
        self.largest = self.largest.max(tick.lateness);
        self.missed += tick.missed;
        self.overruns += u64::from(tick.overran);
    }

    /// What the ticks so far had in common.
    pub fn summary(&self) -> PunctualitySummary {
        let steps = self.histogram.len();
        PunctualitySummary {
            steps,
            missed: self.missed,
            overruns: self.overruns,
            median: self.quantile(0.5),
            percentile_99: self.quantile(0.99),
            largest: (steps > 0).then_some(self.largest),
        }
    }

    /// Lateness that a share of the steps did not exceed, s.
    fn quantile(&self, share: f64) -> Option<f64> {
        // The histogram answers with the upper end of a bin, which may be above what was recorded.
        let value = self.histogram.value_at_quantile(share) as f64 * 1e-9;
        (!self.histogram.is_empty()).then_some(value.min(self.largest))
    }
}

impl fmt::Display for PunctualitySummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} steps", self.steps)?;
        let lateness = (self.median, self.percentile_99, self.largest);
        if let (Some(median), Some(percentile_99), Some(largest)) = lateness {
            let us = |seconds: f64| seconds * 1e6;
            write!(
                f,
                ", late by {:.0} us (median), {:.0} us (99 %), {:.0} us (at most)",
                us(median),
                us(percentile_99),
                us(largest)
            )?;
        }
        write!(
            f,
            "; {} periods missed, {} steps overran",
            self.missed, self.overruns
        )
    }
}
