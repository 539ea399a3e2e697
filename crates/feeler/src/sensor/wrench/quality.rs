//! Quality of a wrench calibration: errors on held-out samples.

use super::WrenchAxis;
use crate::sensor::calibration::outlier::{MIN_SHARE, MISTYPED, robust_deviation};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Minimum number of samples with increasing and with decreasing load for an estimate of hysteresis.
const MIN_CYCLED: usize = 3;

/// Statistics of the errors (predicted minus measured) on held-out samples (N, N·m or m).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Errors {
    /// Number of samples.
    pub rows: usize,
    /// Root mean square error.
    pub rmse: f64,
    /// Mean absolute error.
    pub mae: f64,
    /// Mean error; if a whole recording was held out, the drift between recordings.
    pub bias: f64,
}

impl Errors {
    /// Computes the statistics of `errors`; `None` if empty.
    pub fn of(errors: impl IntoIterator<Item = f64>) -> Option<Self> {
        let (mut rows, mut squares, mut magnitudes, mut sum) = (0, 0.0, 0.0, 0.0);
        for error in errors {
            rows += 1;
            squares += error * error;
            magnitudes += error.abs();
            sum += error;
        }
        let count = rows as f64;
        (rows > 0).then(|| Self {
            rows,
            rmse: (squares / count).sqrt(),
            mae: magnitudes / count,
            bias: sum / count,
        })
    }
}

/// Prediction errors on the samples of one recording.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingQuality {
    /// Name of the recording.
    pub name: String,
    /// Errors if blocks of time are held out and the rest of the recording is used for training.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blocks: Option<Errors>,
    /// Errors if the whole recording is held out; `None` if there is no other recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<Errors>,
}

/// Prediction errors of one component.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisQuality {
    /// The component.
    pub axis: WrenchAxis,
    /// Minimum and maximum of the measured values (N, N·m or m).
    pub range: [f64; 2],
    /// Root mean square error of the constant prediction by the mean of the measured values, for comparison (N, N·m or
    /// m).
    pub mean_rmse: f64,
    /// Errors if blocks of time are held out. Everything is fitted again without them, including the choice of terms
    /// and penalty.
    pub blocks: Errors,
    /// R² with blocks held out: 1 for perfect predictions, 0 for predictions no better than the mean.
    pub r2: f64,
    /// Hysteresis: mean error under increasing load minus mean error under decreasing load, with blocks held out (N,
    /// N·m or m); `None` if unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hysteresis: Option<f64>,
    /// Half-width of the error band that contains 95 % of the valid samples (N, N·m or m), from held-out recordings and
    /// blocks of time; `None` if there are too few samples. Includes hysteresis and preload, which the novelty check
    /// does not detect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band_95: Option<f64>,
    /// Errors by recording.
    pub recordings: Vec<RecordingQuality>,
}

impl AxisQuality {
    /// Returns `error` in % of the measured range.
    pub fn percent(&self, error: f64) -> f64 {
        100.0 * error / (self.range[1] - self.range[0])
    }

    /// Returns `true` if predictions are better than the constant mean of the measured values.
    pub fn explains(&self) -> bool {
        self.r2 > 0.0
    }
}

/// Measured value of one component in one sample, with its held-out predictions (N, N·m or m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// Index of the recording.
    pub recording: usize,
    /// Measured value.
    pub measured: f64,
    /// Prediction by a model fitted without the sample's block of time.
    pub by_blocks: Option<f64>,
    /// Prediction by a model fitted without the sample's recording.
    pub by_recording: Option<f64>,
    /// Novelty distance of the sample in a model fitted without its block of time.
    pub distance_by_blocks: Option<f64>,
    /// Novelty distance of the sample in a model fitted without its recording.
    pub distance_by_recording: Option<f64>,
}

/// Minimum number of samples for an error band.
const MIN_IMAGES: usize = 20;

/// Minimum number of samples of a held-out recording for it to be included in the error band.
const MIN_OF_RECORDING: usize = 5;

/// Returns the quantile `part` (0 to 1) of `values`; `None` if empty.
pub(super) fn quantile(mut values: Vec<f64>, part: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let place = (part * values.len() as f64) as usize;
    values.get(place).or(values.last()).copied()
}

/// Half-width of the error band that contains 95 % of the samples within novelty distance `limit` (N, N·m or m); `None`
/// if there are fewer than 20 samples.
///
/// The larger of two bands: the 95 % quantile of the errors over blocks of time, and the prediction interval of a new
/// recording, 1.96 s √(1 + 1/m) with the root mean square error s of m held-out recordings. Only samples within `limit`
/// are used.
pub(super) fn band_95(held_out: &[HeldOut], limit: f64) -> Option<f64> {
    let near = |distance: Option<f64>| distance.is_some_and(|distance| distance <= limit);
    let error = |predicted: Option<f64>, h: &HeldOut| Some((predicted? - h.measured).abs());
    let blocks = held_out.iter().filter(|h| near(h.distance_by_blocks));
    let blocks: Vec<f64> = blocks.filter_map(|h| error(h.by_blocks, h)).collect();
    if blocks.len() < MIN_IMAGES {
        return None;
    }
    let within = quantile(blocks, 0.95)?;
    let mut recordings: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for h in held_out.iter().filter(|h| near(h.distance_by_recording)) {
        let errors = recordings.entry(h.recording).or_default();
        errors.extend(error(h.by_recording, h));
    }
    let recordings = recordings
        .into_values()
        .filter(|errors| errors.len() >= MIN_OF_RECORDING);
    let recordings: Vec<Errors> = recordings.filter_map(Errors::of).collect();
    let count = recordings.len() as f64;
    if recordings.is_empty() {
        return Some(within);
    }
    let squares: f64 = recordings.iter().map(|errors| errors.rmse.powi(2)).sum();
    let between = 1.96 * (squares / count * (1.0 + 1.0 / count)).sqrt();
    Some(within.max(between))
}

/// Returns the measured value farthest from its prediction if it is probably mistyped: the error exceeds 15 standard
/// deviations of the errors and a tenth of the range of the other values.
pub fn outlier(held_out: &[HeldOut]) -> Option<HeldOut> {
    /// Minimum number of values for detecting an outlier.
    const MIN_ROWS: usize = 30;
    let error = |h: &HeldOut| Some((h.by_blocks? - h.measured).abs());
    let usual = robust_deviation(held_out.iter().filter_map(error));
    let by_error = |&a: &usize, &b: &usize| {
        let [a, b] = [a, b].map(|place| error(&held_out[place]).unwrap_or(0.0));
        a.total_cmp(&b)
    };
    let worst = (0..held_out.len()).max_by(by_error)?;
    let others = held_out
        .iter()
        .enumerate()
        .filter(|(place, _)| *place != worst);
    let ends = others.fold(
        [f64::INFINITY, f64::NEG_INFINITY],
        |[low, high], (_, other)| [low.min(other.measured), high.max(other.measured)],
    );
    let limit = (MISTYPED * usual).max(MIN_SHARE * (ends[1] - ends[0]));
    let is_far = held_out.len() >= MIN_ROWS && error(&held_out[worst])? > limit;
    is_far.then_some(held_out[worst])
}

/// Computes the quality of `axis` from held-out predictions in order of time; `None` if there are no predictions.
pub(super) fn judge(
    axis: WrenchAxis,
    held_out: &[HeldOut],
    names: &[String],
) -> Option<AxisQuality> {
    let by_blocks = |h: &HeldOut| Some(h.by_blocks? - h.measured);
    let by_recording = |h: &HeldOut| Some(h.by_recording? - h.measured);
    let blocks = Errors::of(held_out.iter().filter_map(by_blocks))?;
    let judged = held_out.iter().filter(|h| h.by_blocks.is_some());
    let judged: Vec<f64> = judged.map(|h| h.measured).collect();
    let mean = judged.iter().sum::<f64>() / judged.len() as f64;
    let of_mean = Errors::of(judged.iter().map(|measured| mean - measured))?;
    let all = held_out.iter().map(|h| h.measured);
    let range = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    let recordings = names.iter().enumerate().filter_map(|(index, name)| {
        let own = || held_out.iter().filter(|h| h.recording == index);
        own().next()?;
        Some(RecordingQuality {
            name: name.clone(),
            blocks: Errors::of(own().filter_map(by_blocks)),
            left_out: Errors::of(own().filter_map(by_recording)),
        })
    });
    Some(AxisQuality {
        axis,
        range,
        mean_rmse: of_mean.rmse,
        blocks,
        r2: 1.0 - (blocks.rmse / of_mean.rmse).powi(2),
        hysteresis: hysteresis(held_out),
        band_95: None,
        recordings: recordings.collect(),
    })
}

/// Mean error under increasing load minus mean error under decreasing load; `None` if unknown.
fn hysteresis(held_out: &[HeldOut]) -> Option<f64> {
    let (mut growing, mut falling) = (Vec::new(), Vec::new());
    for pair in held_out.windows(2) {
        let [before, now] = [pair[0], pair[1]];
        let Some(predicted) = now.by_blocks.filter(|_| before.recording == now.recording) else {
            continue;
        };
        let error = predicted - now.measured;
        match now.measured.abs().total_cmp(&before.measured.abs()) {
            std::cmp::Ordering::Greater => growing.push(error),
            std::cmp::Ordering::Less => falling.push(error),
            std::cmp::Ordering::Equal => {}
        }
    }
    let mean = |errors: &[f64]| errors.iter().sum::<f64>() / errors.len() as f64;
    let enough = growing.len().min(falling.len()) >= MIN_CYCLED;
    enough.then(|| mean(&growing) - mean(&falling))
}
