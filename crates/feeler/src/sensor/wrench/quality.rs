//! How far a wrench calibration can be trusted: errors on pictures that it has not seen.

use super::WrenchAxis;
use crate::sensor::calibration_fit::outlier::{LEAST_SHARE, MISTYPED, robust_deviation};
use serde::{Deserialize, Serialize};

/// Least number of readings while the load grew, and while it fell, that tell hysteresis.
const LEAST_CYCLED: usize = 3;

/// Errors (predicted less measured) on pictures that the prediction has not seen, N or N m.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Errors {
    /// Number of pictures.
    pub rows: usize,
    /// Root mean square.
    pub rmse: f64,
    /// Mean magnitude.
    pub mae: f64,
    /// Mean: where a whole recording was left out, the drift between recordings.
    pub bias: f64,
}

impl Errors {
    /// Of these errors; none where there are none.
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

/// Errors in one recording.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingQuality {
    /// Name of the recording.
    pub name: String,
    /// Blocks of time left out, the rest of the recording known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blocks: Option<Errors>,
    /// The whole recording left out; none where there is no other to learn from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<Errors>,
}

/// How far one component is off.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisQuality {
    /// The component.
    pub axis: WrenchAxis,
    /// Least and greatest that was measured, N or N m.
    pub range: [f64; 2],
    /// Root mean square error of predicting the mean of what was measured, N or N m.
    pub mean_rmse: f64,
    /// Blocks of time left out. Everything is learnt anew without them, the choice of terms and penalty included.
    pub blocks: Errors,
    /// Part of the variance that is explained, blocks left out: 1 is all of it, 0 as much as the mean explains.
    pub r2: f64,
    /// Mean error while the magnitude grew less that while it fell, blocks left out, N or N m; none where too few pictures tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hysteresis: Option<f64>,
    /// By recording.
    pub recordings: Vec<RecordingQuality>,
}

impl AxisQuality {
    /// `error` in % of the measured range.
    pub fn percent(&self, error: f64) -> f64 {
        100.0 * error / (self.range[1] - self.range[0])
    }

    /// Whether predictions are nearer to what was measured than its mean is.
    pub fn explains(&self) -> bool {
        self.r2 > 0.0
    }
}

/// One component in one picture: what was measured, and what is predicted by what has not seen it, N or N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// Index of the recording.
    pub recording: usize,
    /// What was measured.
    pub measured: f64,
    /// Predicted without the picture's block of time.
    pub by_blocks: Option<f64>,
    /// Predicted without the picture's recording.
    pub by_recording: Option<f64>,
}

/// The measured value that is farthest from what is predicted of it, if it is out of proportion, as a mistyped one is: by more than
/// 15 standard deviations of the errors, and a tenth of the range of the other values.
pub fn outlier(held_out: &[HeldOut]) -> Option<HeldOut> {
    /// Least values among which one can be told from the others.
    const LEAST_ROWS: usize = 30;
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
    let limit = (MISTYPED * usual).max(LEAST_SHARE * (ends[1] - ends[0]));
    let is_far = held_out.len() >= LEAST_ROWS && error(&held_out[worst])? > limit;
    is_far.then_some(held_out[worst])
}

/// The quality of `axis` by what was predicted of it, in the order of time; none where nothing was.
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
        recordings: recordings.collect(),
    })
}

/// Mean error while the magnitude grows less that while it falls.
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
    let enough = growing.len().min(falling.len()) >= LEAST_CYCLED;
    enough.then(|| mean(&growing) - mean(&falling))
}
