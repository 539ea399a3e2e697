//! Results of a grip law over many trials.

use super::GripTrial;
use crate::sweep::analysis::bootstrap;
use feeler_report::figures::sweep::wilson;
use feeler_report::pages::{Curve, Curves};

/// Number of bins of a curve.
const BINS: usize = 8;

/// Results of one trial, as in the table of trials.
#[derive(Debug, Clone, PartialEq)]
pub struct GripRow {
    /// Number of the trial.
    pub trial: u64,
    /// `true` if the object was dropped.
    pub dropped: bool,
    /// `true` if the object was crushed.
    pub crushed: bool,
    /// Mean grip, and mean of the minimum grip that holds, in the air (N).
    pub grips: [f64; 2],
    /// Largest force of a finger (N), and the force that crushes the object (N).
    pub peak: [f64; 2],
    /// Distance that the object slid in the grip (m).
    pub slid: f64,
    /// Reaction times from the onset of a slip to an increase of the grip (s); infinite if it did not rise within a
    /// second.
    pub reactions: Vec<f64>,
    /// Outcome of the task.
    pub outcome: &'static str,
}

impl GripRow {
    /// Names of the fields of [`fields`](Self::fields).
    pub const HEADER: &str = "trial,outcome,dropped,crushed,mean_grip_n,mean_least_grip_n,peak_force_n,crush_force_n,slid_m,reactions_s";

    /// Creates the row of `trial`.
    pub fn new(trial: u64, ran: &GripTrial) -> Self {
        let meter = &ran.meter;
        Self {
            trial,
            dropped: ran.dropped(),
            crushed: ran.crushed(),
            grips: meter.mean_grips(),
            peak: [meter.peak, ran.object.crush_force(meter.peak_least)],
            slid: meter.slid,
            reactions: (meter.reactions.iter())
                .map(|time| time.unwrap_or(f64::INFINITY))
                .collect(),
            outcome: ran.outcome.unwrap_or("time limit"),
        }
    }

    /// The row as comma-separated fields. Reactions are separated by spaces.
    pub fn fields(&self) -> String {
        let reactions: Vec<_> = self
            .reactions
            .iter()
            .map(|time| format!("{time:.3}"))
            .collect();
        format!(
            "{},{},{},{},{:.4},{:.4},{:.4},{:.4},{:.5},{}",
            self.trial,
            self.outcome,
            u8::from(self.dropped),
            u8::from(self.crushed),
            self.grips[0],
            self.grips[1],
            self.peak[0],
            self.peak[1],
            self.slid,
            reactions.join(" ")
        )
    }

    /// `true` if the object was dropped or crushed.
    fn failed(&self) -> bool {
        self.dropped || self.crushed
    }

    /// Mean grip relative to the mean of the minimum grip that holds; `None` if the object was dropped.
    fn excess(&self) -> Option<f64> {
        let excess = self.grips[0] / self.grips[1];
        (excess.is_finite() && !self.dropped).then_some(excess)
    }
}

/// Results of a law. Ranges are 95 % intervals, `[low, estimate, high]`.
#[derive(Debug, Clone, PartialEq)]
pub struct GripScore {
    /// Share of the objects that were dropped.
    pub dropped: [f64; 3],
    /// Share of the objects that were crushed.
    pub crushed: [f64; 3],
    /// Share of the objects that were dropped or crushed.
    pub failed: [f64; 3],
    /// Mean over the held objects of the ratio of the grip to the minimum grip that holds; `None` if no object was
    /// held.
    pub excess: Option<[f64; 3]>,
    /// Sum of the mean grips divided by the sum of the mean minimum grips.
    pub excess_of_sums: f64,
    /// Number of slips of a whole contact while the object was in the air.
    pub slips: usize,
    /// Median and 95th percentile of the reaction time from the onset of a slip to an increase of the grip (s); `None`
    /// without slips.
    pub reaction: Option<[f64; 2]>,
}

impl GripScore {
    /// Computes the results of `rows`.
    pub fn new(rows: &[GripRow]) -> Self {
        let count = rows.len() as u64;
        let share = |bad: fn(&GripRow) -> bool| {
            let bad = rows.iter().filter(|row| bad(row)).count() as u64;
            let (low, high) = wilson(bad, count);
            [low, bad as f64 / count.max(1) as f64, high]
        };
        let held = || rows.iter().filter(|row| row.excess().is_some());
        let excess: Vec<f64> = held().filter_map(GripRow::excess).collect();
        let sum = |which: usize| held().map(|row| row.grips[which]).sum::<f64>();
        let mut reactions: Vec<f64> = rows.iter().flat_map(|row| row.reactions.clone()).collect();
        reactions.sort_by(f64::total_cmp);
        let quantile = |share: f64| {
            let index = (share * reactions.len() as f64).ceil() as usize;
            reactions.get(index.saturating_sub(1)).copied()
        };
        Self {
            dropped: share(|row| row.dropped),
            crushed: share(|row| row.crushed),
            failed: share(GripRow::failed),
            excess: bootstrap(&excess).map(|mean| [mean.low, mean.mean, mean.high]),
            excess_of_sums: sum(0) / sum(1),
            slips: reactions.len(),
            reaction: quantile(0.5).zip(quantile(0.95)).map(Into::into),
        }
    }
}

/// Differences between two laws on the same objects: mean over the objects with its 95 % bootstrap interval,
/// `[low, mean, high]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GripDifference {
    /// Share of objects that this law dropped, minus that of the reference.
    pub dropped: [f64; 3],
    /// Share of objects that it crushed, minus that of the reference.
    pub crushed: [f64; 3],
    /// Share of objects that it dropped or crushed, minus that of the reference.
    pub failed: [f64; 3],
}

impl GripDifference {
    /// Compares `rows` with those of a `reference` on the same objects. `None` without objects.
    pub fn new(rows: &[GripRow], reference: &[GripRow]) -> Option<Self> {
        let of = |bad: fn(&GripRow) -> bool| {
            let number = |row: &GripRow| f64::from(u8::from(bad(row)));
            let pairs = rows.iter().zip(reference);
            let differences: Vec<f64> = pairs.map(|(a, b)| number(a) - number(b)).collect();
            bootstrap(&differences).map(|mean| [mean.low, mean.mean, mean.high])
        };
        Some(Self {
            dropped: of(|row| row.dropped)?,
            crushed: of(|row| row.crushed)?,
            failed: of(GripRow::failed)?,
        })
    }
}

/// Ratio of the grip to the minimum grip over the load, for each law: mean with its 95 % interval in bins of equally
/// many objects.
pub fn excess_over_load(laws: &[(String, Vec<GripRow>)]) -> Curves {
    let curve = |(law, rows): &(String, Vec<GripRow>)| {
        let mut held: Vec<_> = rows
            .iter()
            .filter_map(|row| Some((row.grips[1], row.excess()?)))
            .collect();
        held.sort_by(|a, b| a.0.total_cmp(&b.0));
        let size = held.len().div_ceil(BINS).max(1);
        let points = held.chunks(size).filter_map(|bin| {
            let excess: Vec<f64> = bin.iter().map(|held| held.1).collect();
            let mean = bootstrap(&excess)?;
            let load = bin.iter().map(|held| held.0).sum::<f64>() / bin.len() as f64;
            Some((load, mean.with_ends(bin.len())))
        });
        Curve {
            law: law.clone(),
            points: points.collect(),
        }
    };
    Curves {
        title: "Mean grip relative to the least that holds".to_string(),
        against: "least grip that holds (N)".to_string(),
        curves: laws.iter().map(curve).collect(),
    }
}
