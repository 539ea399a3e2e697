//! Statistics of a grip law over many trials.

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
    /// Mean grip, and mean of the load divided by twice the coefficient of static friction, both while the object is in
    /// the air (N).
    pub grips: [f64; 2],
    /// Least mean grip with which an oracle held the object (N), if measured: see [`GripTrial::least_grip`].
    pub least: Option<f64>,
    /// Largest force of a finger (N), and the force that crushes the object (N).
    pub peak: [f64; 2],
    /// Distance that the object slid in the grip (m).
    pub slid: f64,
    /// Time from each onset of slip until the fingers have closed to press harder (s); infinite if they did not within a
    /// second.
    pub reactions: Vec<f64>,
    /// Outcome of the task.
    pub outcome: &'static str,
}

impl GripRow {
    /// Names of the fields of [`fields`](Self::fields).
    pub const HEADER: &str = "trial,outcome,dropped,crushed,mean_grip_n,mean_load_grip_n,least_grip_n,peak_force_n,crush_force_n,slid_m,reactions_s";

    /// Creates the row of `trial`. An oracle held the object with a mean grip of `least` (N), if measured.
    pub fn new(trial: u64, ran: &GripTrial, least: Option<f64>) -> Self {
        let meter = &ran.meter;
        Self {
            trial,
            dropped: ran.dropped(),
            crushed: ran.crushed(),
            grips: meter.mean_grips(),
            least,
            peak: [meter.peak, ran.object.crush_force(meter.peak_required)],
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
        let least = self.least.map(|least| format!("{least:.4}"));
        format!(
            "{},{},{},{},{:.4},{:.4},{},{:.4},{:.4},{:.5},{}",
            self.trial,
            self.outcome,
            u8::from(self.dropped),
            u8::from(self.crushed),
            self.grips[0],
            self.grips[1],
            least.unwrap_or_default(),
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

    /// Ratio of the mean grip to the load divided by twice the coefficient of static friction; `None` if the object was
    /// dropped.
    fn excess_of_load(&self) -> Option<f64> {
        let excess = self.grips[0] / self.grips[1];
        (excess.is_finite() && !self.dropped).then_some(excess)
    }

    /// Ratio of the mean grip to the least grip with which an oracle held the object; `None` if the object was dropped.
    fn excess(&self) -> Option<f64> {
        let least = self.least.filter(|_| !self.dropped)?;
        Some(self.grips[0] / least)
    }
}

/// Statistics of a law. `[low, estimate, high]` is an estimate with its 95 % interval.
#[derive(Debug, Clone, PartialEq)]
pub struct GripScore {
    /// Share of the objects that were dropped.
    pub dropped: [f64; 3],
    /// Share of the objects that were crushed.
    pub crushed: [f64; 3],
    /// Share of the objects that were dropped or crushed.
    pub failed: [f64; 3],
    /// Mean over the held objects of the mean grip relative to the least with which an oracle held them; `None` if not
    /// measured.
    pub excess: Option<[f64; 3]>,
    /// Mean over the held objects of the mean grip relative to the load over twice the static friction; `None` if none was
    /// held. Torsion and kinetic friction count as excess, so it is above 1 for every gripper.
    pub excess_of_load: Option<[f64; 3]>,
    /// Ratio of the sum of the mean grips to the sum of the grips that the loads require.
    pub excess_of_sums: f64,
    /// Number of slips of a whole contact in the air.
    pub slips: usize,
    /// Median and 95th percentile of the time from the onset of slip until the fingers have closed to press harder (s); `None`
    /// without slips.
    pub reaction: Option<[f64; 2]>,
}

impl GripScore {
    /// Computes the statistics of `rows`.
    pub fn new(rows: &[GripRow]) -> Self {
        let count = rows.len() as u64;
        let share = |bad: fn(&GripRow) -> bool| {
            let bad = rows.iter().filter(|row| bad(row)).count() as u64;
            let (low, high) = wilson(bad, count);
            [low, bad as f64 / count.max(1) as f64, high]
        };
        let held = || rows.iter().filter(|row| row.excess_of_load().is_some());
        let mean = |of: fn(&GripRow) -> Option<f64>| {
            let excess: Vec<f64> = rows.iter().filter_map(of).collect();
            bootstrap(&excess).map(|mean| [mean.low, mean.mean, mean.high])
        };
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
            excess: mean(GripRow::excess),
            excess_of_load: mean(GripRow::excess_of_load),
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
    /// Share of objects that this law crushed, minus that of the reference.
    pub crushed: [f64; 3],
    /// Share of objects that this law dropped or crushed, minus that of the reference.
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

/// Mean grip of each law against the load over twice the static friction: mean with its 95 % interval in bins of equally
/// many objects. The last curve is the lower bound.
pub fn grip_over_load(laws: &[(String, Vec<GripRow>)]) -> Curves {
    let curve = |(law, rows): &(String, Vec<GripRow>)| {
        let held = rows.iter().filter(|row| row.excess_of_load().is_some());
        let mut held: Vec<_> = held.map(|row| row.grips).collect();
        held.sort_by(|a, b| a[1].total_cmp(&b[1]));
        let size = held.len().div_ceil(BINS).max(1);
        let points = held.chunks(size).filter_map(|bin| {
            let grips: Vec<f64> = bin.iter().map(|held| held[0]).collect();
            let mean = bootstrap(&grips)?;
            let load = bin.iter().map(|held| held[1]).sum::<f64>() / bin.len() as f64;
            Some((load, mean.with_ends(bin.len())))
        });
        Curve {
            law: law.clone(),
            points: points.collect(),
        }
    };
    let mut curves: Vec<_> = laws.iter().map(curve).collect();
    let loads = curves.first().map_or_else(Vec::new, |first| {
        first.points.iter().map(|point| point.0).collect()
    });
    curves.push(Curve {
        law: "lower bound".to_string(),
        points: loads.into_iter().map(|load| (load, [load; 3])).collect(),
    });
    Curves {
        title: "Mean grip (N)".to_string(),
        against: "load over twice the static friction (N)".to_string(),
        curves,
    }
}
