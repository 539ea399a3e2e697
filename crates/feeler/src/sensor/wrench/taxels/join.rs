//! Assigns measured wrenches to the rows of taxel recordings by time.

use super::TaxelSample;
use super::memory::{TIME_CONSTANTS, TaxelInput};
use crate::sensor::wrench::basis::zero_if_nan;
use crate::sensor::wrench::ridge::regress;
use crate::sensor::wrench::{AXES, MeasuredWrench};
use nalgebra::{DMatrix, DVector};

/// Maximum magnitude of the estimated delay, s.
pub const MAX_DELAY: f64 = 0.5;
/// Step sizes of the search for the delay, s: coarse, then fine around the best coarse value.
const STEPS: [f64; 2] = [0.05, 0.01];
/// Maximum ratio of the squared errors with and without a delay for the delay to be used. Creep of the skin resembles a
/// delay, but memory models it better.
const MAX_ERROR_RATIO: f64 = 0.5;
/// Unexplained fraction of the variance below which a prediction counts as exact.
const MIN_ERROR: f64 = 1e-9;
/// Maximum interval between measurements that are interpolated, relative to the median interval.
const MAX_GAP: f64 = 4.0;
/// Ridge penalty of the regression in the search for the delay, relative to the mean squared reading.
const PENALTY: f64 = 1e-6;

/// A wrench with its time of measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredAt {
    /// Time, s, on the clock of the taxels' stamps except for the delay.
    pub time: f64,
    /// Measured wrench.
    pub wrench: MeasuredWrench,
}

/// One recording of a taxel array, with the wrenches measured during it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TaxelSeries {
    /// Time of each row of taxel readings, s.
    pub stamps: Vec<f64>,
    /// Taxel readings of each row.
    pub inputs: Vec<TaxelInput>,
    /// Measured wrenches, ordered by time.
    pub measured: Vec<MeasuredAt>,
}

impl TaxelSeries {
    /// Disables memory if the median interval between rows exceeds the shortest of [`TIME_CONSTANTS`], by setting the
    /// filters to the readings.
    pub fn forget_if_sparse(&mut self) {
        if median_interval(&self.stamps) <= TIME_CONSTANTS[0] {
            return;
        }
        for TaxelInput { values, filtered } in &mut self.inputs {
            for (filtered, value) in filtered.iter_mut().zip(values) {
                filtered.fill(*value);
            }
        }
    }
}

/// Returns a sample for each row of `series` for which the wrench at stamp + `delay` (s) can be interpolated between two
/// measurements. `series` are the recordings, in order of their indices.
pub fn join(series: &[TaxelSeries], delay: f64) -> Vec<TaxelSample> {
    let joined = joined(series, delay).into_iter();
    let samples = joined.map(
        |Joined {
             recording,
             input,
             wrench,
         }| TaxelSample {
            recording,
            seen: input.clone(),
            wrench,
        },
    );
    samples.collect()
}

/// A row of taxel readings with the wrench interpolated at its time.
struct Joined<'a> {
    recording: usize,
    input: &'a TaxelInput,
    wrench: MeasuredWrench,
}

/// Like [`join`], without copying the rows.
fn joined(series: &[TaxelSeries], delay: f64) -> Vec<Joined<'_>> {
    let joined = series.iter().enumerate().flat_map(|(recording, series)| {
        let components = MeasuredSeries::of_each_axis(&series.measured);
        let rows = series.stamps.iter().zip(&series.inputs);
        rows.filter_map(move |(stamp, input)| {
            let wrench: MeasuredWrench =
                std::array::from_fn(|axis| components[axis].at(stamp + delay));
            let measured = wrench.iter().any(Option::is_some);
            measured.then_some(Joined {
                recording,
                input,
                wrench,
            })
        })
    });
    joined.collect()
}

/// Estimates the delay of the measured wrenches relative to the taxels, s, between -[`MAX_DELAY`] and [`MAX_DELAY`]:
/// the delay for which a linear regression on the readings explains the wrenches best. Returns 0 if it does not halve
/// the squared error (geometric mean over the components).
pub fn estimate_delay(series: &[TaxelSeries]) -> f64 {
    let rows = joined(series, 0.0).len();
    let error = |delay: f64| (squared_error(series, delay, rows), delay);
    let least = |a: &(f64, f64), b: &(f64, f64)| a.0.total_cmp(&b.0);
    let unaligned = error(0.0);
    let mut best = unaligned;
    let mut reach = MAX_DELAY;
    for step in STEPS {
        let steps = (reach / step).round() as i32;
        let middle = best.1;
        let around = (-steps..=steps).map(|offset| middle + f64::from(offset) * step);
        let around = around.filter(|delay| delay.abs() <= MAX_DELAY + 1e-9);
        best = around.map(error).min_by(least).unwrap_or(best);
        reach = step;
    }
    match best.0 < MAX_ERROR_RATIO * unaligned.0 {
        true => best.1,
        false => 0.0,
    }
}

/// Fraction of the variance not explained by a linear regression on the readings: the geometric mean over the
/// components. Infinite if `delay` gives far fewer samples than `rows`, the number without a delay.
fn squared_error(series: &[TaxelSeries], delay: f64, rows: usize) -> f64 {
    let samples = joined(series, delay);
    if samples.len() * 5 < rows * 4 {
        return f64::INFINITY;
    }
    let errors: Vec<f64> = (0..AXES)
        .filter_map(|axis| unexplained(&samples, axis))
        .map(|error| libm::log(error.max(MIN_ERROR)))
        .collect();
    libm::exp(errors.iter().sum::<f64>() / errors.len().max(1) as f64)
}

/// Fraction of the variance of a component not explained by a linear regression on the readings; `None` if the
/// component is constant or was not measured.
fn unexplained(samples: &[Joined], axis: usize) -> Option<f64> {
    let rows = samples.iter();
    let rows = rows.filter_map(|sample| Some((sample.input, sample.wrench[axis]?)));
    let (inputs, measured): (Vec<_>, Vec<_>) = rows.unzip();
    let terms = 3 * inputs.first()?.values.len();
    let values = inputs.iter().flat_map(|input| {
        let values = input.values.iter().flat_map(|value| value.to_array());
        values.map(zero_if_nan)
    });
    let matrix = DMatrix::from_row_iterator(inputs.len(), terms, values);
    let penalty = PENALTY * matrix.norm_squared() / terms as f64;
    let (intercept, weights) = regress(matrix.clone(), &measured, penalty)?;
    let measured = DVector::from_vec(measured);
    let predicted = (matrix * DVector::from_vec(weights)).add_scalar(intercept);
    let total = measured.add_scalar(-measured.mean()).norm_squared();
    (total > 0.0).then(|| (predicted - measured).norm_squared() / total)
}

/// Measurements of one quantity, for interpolation over time.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredSeries {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Maximum interval for interpolation, s.
    gap: f64,
}

impl MeasuredSeries {
    /// Creates a series of `values` measured at `times`, s, in ascending order.
    pub fn new(times: Vec<f64>, values: Vec<f64>) -> Self {
        Self {
            gap: MAX_GAP * median_interval(&times),
            times,
            values,
        }
    }

    fn of_each_axis(measured: &[MeasuredAt]) -> [Self; AXES] {
        std::array::from_fn(|axis| {
            let known = measured
                .iter()
                .filter_map(|m| Some((m.time, m.wrench[axis]?)));
            let (times, values) = known.unzip();
            Self::new(times, values)
        })
    }

    /// Interpolates linearly at `time`, s. Returns `None` outside the measurements, or in an interval of more than four
    /// times the median.
    pub fn at(&self, time: f64) -> Option<f64> {
        let after = self.times.partition_point(|&measured| measured < time);
        let (&end, &value) = self.times.get(after).zip(self.values.get(after))?;
        if end == time {
            return Some(value);
        }
        let before = after.checked_sub(1)?;
        let (start, first) = (self.times[before], self.values[before]);
        let part = (time - start) / (end - start);
        (end - start <= self.gap).then_some(first + part * (value - first))
    }
}

/// Median interval between distinct `times`, s; 0 if there are fewer than two.
fn median_interval(times: &[f64]) -> f64 {
    let intervals = times.windows(2).map(|pair| pair[1] - pair[0]);
    let mut intervals: Vec<_> = intervals.filter(|&interval| interval > 0.0).collect();
    intervals.sort_by(f64::total_cmp);
    intervals.get(intervals.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// A taxel and a scale that reports the same 0.12 s later, with a gap of 3 s.
    fn series() -> TaxelSeries {
        let force = |time: f64| (1.7 * time).sin() + 0.3 * (5.1 * time).sin();
        let stamps: Vec<f64> = (0..600).map(|row| 0.03 * f64::from(row)).collect();
        let input = |&time: &f64| TaxelInput {
            values: vec![DVec3::new(0.0, 0.0, 250.0 * force(time))],
            filtered: Vec::new(),
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

    #[test]
    fn repeated_measurements_do_not_hide_others() {
        let mut repeated = series();
        let twice = repeated.measured.iter().flat_map(|m| [*m; 2]);
        repeated.measured = twice.collect();
        let count = join(&[series()], 0.12).len();
        assert_eq!(join(&[repeated], 0.12).len(), count);
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
