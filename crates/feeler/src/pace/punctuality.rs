//! Statistics of the lateness of steps.

use super::error::PaceError;
use super::timer::Tick;
use hdrhistogram::Histogram;
use std::fmt;

/// Maximum lateness that the histogram can represent, one hour, in ns. The minimum is 1 ns.
const LONGEST: u64 = 3_600_000_000_000;

/// Significant digits of the percentiles, for a resolution of 1 % in 40 kB.
const DIGITS: u8 = 2;

/// Accumulates statistics of the lateness of ticks. All memory is allocated at creation.
#[derive(Clone, Debug)]
pub struct Punctuality {
    /// Histogram of lateness (ns).
    histogram: Histogram<u64>,
    /// Maximum lateness (s).
    largest: f64,
    missed: u64,
    overruns: u64,
}

/// Statistics of the recorded ticks. Lateness is in s; `None` before the first tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PunctualitySummary {
    /// Number of steps that started, excluding missed ones.
    pub steps: u64,
    /// Number of periods that passed without a step.
    pub missed: u64,
    /// Number of steps that started late because the previous step took too long.
    pub overruns: u64,
    /// Median lateness, with a resolution of 1 %.
    pub median: Option<f64>,
    /// 99th percentile of the lateness, with a resolution of 1 %.
    pub percentile_99: Option<f64>,
    /// Maximum lateness.
    pub largest: Option<f64>,
}

impl Punctuality {
    /// Creates empty statistics.
    ///
    /// # Errors
    /// If the histogram cannot be created.
    pub fn new() -> Result<Self, PaceError> {
        Ok(Self {
            histogram: Histogram::new_with_bounds(1, LONGEST, DIGITS)?,
            largest: 0.0,
            missed: 0,
            overruns: 0,
        })
    }

    /// Adds a tick to the statistics.
    pub fn record(&mut self, tick: &Tick) {
        self.histogram
            .saturating_record((tick.lateness * 1e9).round() as u64);
        self.largest = self.largest.max(tick.lateness);
        self.missed += tick.missed;
        self.overruns += u64::from(tick.overran);
    }

    /// Statistics of the ticks recorded so far.
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

    /// Quantile of the lateness (s), for a `share` from 0 to 1.
    fn quantile(&self, share: f64) -> Option<f64> {
        // The histogram returns the upper end of a bin, which may exceed the largest recorded value.
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
