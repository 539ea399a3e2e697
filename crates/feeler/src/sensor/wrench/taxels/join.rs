//! Aligns recordings of taxels with measured wrenches by time.

use super::TaxelSample;
use super::basis::{TaxelBasis, TaxelKind, TaxelTerms};
use super::memory::TaxelInput;
use crate::sensor::wrench::basis::{Basis, matrix};
use crate::sensor::wrench::ridge::regress;
use crate::sensor::wrench::{AXES, MeasuredWrench};
use nalgebra::DVector;

/// Maximum magnitude of the estimated delay, s.
pub const MAX_DELAY: f64 = 0.5;
/// Steps of the search for the delay, s: coarse, then fine around the best coarse one.
const STEPS: [f64; 2] = [0.05, 0.01];
/// Maximum number of rows used in the search, evenly spread.
const MAX_ROWS: usize = 1000;
/// Maximum fraction of the squared error that may remain for a delay to be preferred to none.
const LEFT: f64 = 0.8;
/// Maximum squared error of a regression without memory, relative to one with memory and without delay, for the forces
/// to count as merely delayed.
const AS_GOOD: f64 = 1.1;
/// Maximum interval between measurements that are interpolated, relative to the median interval.
const MAX_GAP: f64 = 4.0;
/// Penalty of the regression in the search for the delay, relative to the number of rows; features have a variance of 1.
const PENALTY: f64 = 1e-6;

/// A wrench measured at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredAt {
    /// Time, s, on the clock of the taxels' stamps, up to the delay.
    pub time: f64,
    /// Measured wrench.
    pub wrench: MeasuredWrench,
}

/// One recording of a taxel array with the wrenches measured meanwhile.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TaxelSeries {
    /// Time of each row of taxel readings, s.
    pub stamps: Vec<f64>,
    /// Taxel readings of each row.
    pub inputs: Vec<TaxelInput>,
    /// Measured wrenches, ordered by time.
    pub measured: Vec<MeasuredAt>,
}

/// Returns a sample for each row of `series` for which the wrench at stamp + `delay` (s) can be interpolated between two
/// measurements. `series` are the recordings, in order of their indices.
pub fn join(series: &[TaxelSeries], delay: f64) -> Vec<TaxelSample> {
    let samples = series.iter().enumerate().flat_map(|(recording, series)| {
        let lines = Line::of_each_axis(&series.measured);
        let rows = series.stamps.iter().zip(&series.inputs);
        rows.filter_map(move |(stamp, input)| {
            let wrench: MeasuredWrench = std::array::from_fn(|axis| lines[axis].at(stamp + delay));
            wrench.iter().any(Option::is_some).then(|| TaxelSample {
                recording,
                seen: input.clone(),
                wrench,
            })
        })
    });
    samples.collect()
}

/// Estimates the delay of the measured wrenches after the taxels, s, between -[`MAX_DELAY`] and [`MAX_DELAY`].
///
/// A low-pass filter resembles a delay. Therefore, it is the delay with which a linear regression on the readings
/// explains the wrenches best, if it does so as well as a regression with memory ([`TIME_CONSTANTS`]) and without delay.
/// Otherwise the skin creeps: it is the delay that is best with memory if it decreases the squared error by a fifth, and
/// otherwise 0.
///
/// [`TIME_CONSTANTS`]: super::TIME_CONSTANTS
pub fn estimate_delay(series: &[TaxelSeries]) -> f64 {
    let best = |memory| {
        let error = |delay: f64| (squared_error(series, delay, memory), delay);
        let least = |a: &(f64, f64), b: &(f64, f64)| a.0.total_cmp(&b.0);
        let unaligned = error(0.0);
        let mut best = unaligned;
        let mut reach = MAX_DELAY;
        for step in STEPS {
            let steps = (reach / step).round() as i32;
            let middle = best.1;
            let around = (-steps..=steps).map(|place| middle + f64::from(place) * step);
            let around = around.filter(|delay| delay.abs() <= MAX_DELAY + 1e-9);
            best = around.map(error).min_by(least).unwrap_or(best);
            reach = step;
        }
        match best.0 < LEFT * unaligned.0 {
            true => (best, unaligned.0),
            false => (unaligned, unaligned.0),
        }
    };
    let ((error, delay), _) = best(false);
    let ((_, with_memory), unaligned) = best(true);
    match error <= AS_GOOD * unaligned {
        true => delay,
        false => with_memory,
    }
}

/// Sum over the components of the fraction of variance that a linear regression on the readings, with or without memory,
/// leaves unexplained.
fn squared_error(series: &[TaxelSeries], delay: f64, memory: bool) -> f64 {
    let samples = join(series, delay);
    let errors = (0..AXES).filter_map(|axis| {
        let rows: Vec<_> = samples
            .iter()
            .filter_map(|sample| Some((&sample.seen, sample.wrench[axis]?)))
            .collect();
        let step = rows.len().div_ceil(MAX_ROWS).max(1);
        let (inputs, measured): (Vec<_>, Vec<_>) = rows.into_iter().step_by(step).unzip();
        let basis = TaxelBasis::learn(TaxelBasis::elements_of(inputs.first()?), &inputs);
        let features = inputs.iter().map(|input| {
            let mut features = vec![0.0; basis.feature_count()];
            basis.standardise(input, &mut features);
            features
        });
        let features: Vec<_> = features.collect();
        let rows: Vec<_> = (0..features.len()).collect();
        let kind = TaxelKind::Linear;
        let matrix = matrix(&basis, &features, &rows, TaxelTerms { kind, memory });
        let penalty = PENALTY * rows.len() as f64;
        let (intercept, weights) = regress(matrix.clone(), &measured, penalty)?;
        let measured = DVector::from_vec(measured);
        let predicted = (matrix * DVector::from_vec(weights)).add_scalar(intercept);
        let mean = measured.mean();
        let total = measured.add_scalar(-mean).norm_squared();
        (total > 0.0).then(|| (predicted - measured).norm_squared() / total)
    });
    errors.sum()
}

/// Measurements of one component over time.
struct Line {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Maximum interval that is interpolated, s.
    gap: f64,
}

impl Line {
    fn of_each_axis(measured: &[MeasuredAt]) -> [Self; AXES] {
        std::array::from_fn(|axis| {
            let known = measured
                .iter()
                .filter_map(|m| Some((m.time, m.wrench[axis]?)));
            let (times, values): (Vec<f64>, Vec<f64>) = known.unzip();
            let mut intervals: Vec<_> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
            intervals.sort_by(f64::total_cmp);
            let median = intervals.get(intervals.len() / 2);
            Self {
                gap: MAX_GAP * median.copied().unwrap_or(0.0),
                times,
                values,
            }
        })
    }

    /// Interpolates the component at `time`. Returns `None` outside the measurements or in a gap.
    fn at(&self, time: f64) -> Option<f64> {
        let after = self.times.partition_point(|&measured| measured < time);
        let [end, value] = [*self.times.get(after)?, self.values[after]];
        if end == time {
            return Some(value);
        }
        let before = after.checked_sub(1)?;
        let (start, first) = (self.times[before], self.values[before]);
        let part = (time - start) / (end - start);
        (end - start <= self.gap).then(|| first + part * (value - first))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// A taxel that measures sin(t), with a scale that shows the same 0.12 s later, and a gap of 3 s.
    fn series() -> TaxelSeries {
        let force = |time: f64| (1.7 * time).sin() + 0.3 * (5.1 * time).sin();
        let stamps: Vec<f64> = (0..600).map(|row| 0.03 * f64::from(row)).collect();
        let input = |&time: &f64| TaxelInput {
            values: vec![DVec3::new(0.0, 0.0, 250.0 * force(time))],
            slow: Vec::new(),
        };
        let times = (0..160).map(|row| 0.11 * f64::from(row));
        let times = times.filter(|time| !(4.0..7.0).contains(time));
        let measured = times.map(|time| {
            let mut wrench = [None; AXES];
            wrench[2] = Some(force(time - 0.12));
            MeasuredAt { time, wrench }
        });
        TaxelSeries {
            inputs: stamps.iter().map(input).collect(),
            measured: measured.collect(),
            stamps,
        }
    }

    #[test]
    fn delay_of_a_scale_is_found() {
        let delay = estimate_delay(&[series()]);
        assert!((delay - 0.12).abs() < 0.011, "{delay}");
    }

    /// Forces are interpolated between measurements, but not across the gap or outside. The error of linear
    /// interpolation is at most h² max|f''| / 8 = 0.11² × 10.7 / 8 = 0.016.
    #[test]
    fn forces_are_interpolated_except_in_gaps() {
        let series = [series()];
        let samples = join(&series, 0.12);
        let within = |stamp: &&f64| {
            let time = **stamp + 0.12;
            time <= 17.49 && !(3.97..7.03).contains(&time)
        };
        assert_eq!(
            samples.len(),
            series[0].stamps.iter().filter(within).count()
        );
        for sample in samples {
            let force = sample.seen.values[0].z / 250.0;
            assert!((sample.wrench[2].unwrap() - force).abs() < 0.017);
        }
    }
}
