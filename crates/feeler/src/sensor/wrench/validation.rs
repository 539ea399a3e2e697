//! Validates a wrench calibration with predictions of held-out samples by refitted models.

use super::WrenchAxis;
use super::basis::Basis;
use super::blocks::{Fold, blocks, recordings};
use super::calibration::WrenchModel;
use super::learn::learn;
use super::novelty::NEAR;
use super::quality::{AxisQuality, HeldOut, judge, quantile};
use super::sample::{SampleOf, recording_of};
use std::thread;

/// Number of blocks of time per recording.
const BLOCKS: usize = 5;
/// Maximum number of folds that hold out recordings.
const MAX_RECORDINGS: usize = 10;

/// Results of validating a calibration.
pub(super) struct Validated {
    axes: Vec<(AxisQuality, Vec<HeldOut>)>,
    /// Novelty distance of each sample from the samples of other blocks.
    distances: Vec<f64>,
}

impl Validated {
    /// Returns the quality of a component and its held-out predictions, or `None` if it was not validated.
    pub fn of(&self, axis: WrenchAxis) -> Option<(&AxisQuality, &[HeldOut])> {
        let found = self.axes.iter().find(|(quality, _)| quality.axis == axis);
        found.map(|(quality, held_out)| (quality, &held_out[..]))
    }

    /// Quantile [`NEAR`] of the distances of samples from those of other blocks; 1 if unknown.
    pub fn near(&self) -> f64 {
        let distances = self.distances.iter().copied();
        let distances = distances.filter(|d| d.is_finite() && *d > 0.0);
        quantile(distances.collect(), NEAR).unwrap_or(1.0)
    }
}

/// Predicts each sample with models refitted without its block and without its recording.
pub(super) fn validate<B: Basis>(
    samples: &[&SampleOf<B>],
    model: &WrenchModel<B>,
    names: &[String],
) -> Validated {
    let recording_of = recording_of(samples);
    let by_blocks = held_out(samples, model, &blocks(&recording_of, BLOCKS));
    let by_recording = held_out(samples, model, &recordings(&recording_of, MAX_RECORDINGS));
    let axes = model.axes.iter().enumerate().filter_map(|(place, axis)| {
        let rows = samples.iter().enumerate();
        let held_out = rows.filter_map(|(row, sample)| {
            let of = |predicted: &[Option<Predicted>]| predicted[row].as_ref()?.values[place];
            let distance =
                |predicted: &[Option<Predicted>]| Some(predicted[row].as_ref()?.distance);
            Some(HeldOut {
                recording: sample.recording,
                measured: sample.wrench[axis.axis.index()]?,
                by_blocks: of(&by_blocks),
                by_recording: of(&by_recording),
                distance_by_blocks: distance(&by_blocks),
                distance_by_recording: distance(&by_recording),
            })
        });
        let held_out: Vec<_> = held_out.collect();
        Some((judge(axis.axis, &held_out, names)?, held_out))
    });
    let distances = by_blocks.iter().flatten().map(|p| p.distance);
    Validated {
        axes: axes.collect(),
        distances: distances.collect(),
    }
}

/// Prediction of a held-out sample.
#[derive(Clone)]
pub(super) struct Predicted {
    /// Prediction of each component of the full model; `None` if there is too little data for it without the fold.
    pub values: Vec<Option<f64>>,
    /// Novelty distance of the sample.
    pub distance: f64,
}

impl Predicted {
    /// Predicts the components `axes` from a measurement; `None` for components that `model` does not contain.
    pub fn new<B: Basis>(model: &WrenchModel<B>, axes: &[WrenchAxis], seen: &B::Input) -> Self {
        let basis = &model.elements;
        let mut features = vec![0.0; basis.feature_count()];
        basis.standardise(seen, &mut features);
        let values = axes.iter().map(|axis| {
            let own = model.axes.iter().find(|own| own.axis == *axis)?;
            Some(own.value(basis, &features))
        });
        Self {
            values: values.collect(),
            distance: model.novelty.distance(basis, &features),
        }
    }
}

/// Predicts each sample with a model of the same components, fitted without the sample's fold.
fn held_out<B: Basis>(
    samples: &[&SampleOf<B>],
    whole: &WrenchModel<B>,
    folds: &[Fold],
) -> Vec<Option<Predicted>> {
    let mut predicted = vec![None; samples.len()];
    let workers = thread::available_parallelism().map_or(1, usize::from);
    for folds in folds.chunks(workers) {
        let found = thread::scope(|scope| {
            let running = folds
                .iter()
                .map(|fold| scope.spawn(|| predict_fold(samples, whole, fold)));
            let running: Vec<_> = running.collect();
            // A thread that panicked contributes no predictions.
            let ended = running.into_iter().map(|thread| thread.join());
            ended.map(Result::unwrap_or_default).collect::<Vec<_>>()
        });
        for (row, prediction) in found.into_iter().flatten() {
            predicted[row] = Some(prediction);
        }
    }
    predicted
}

fn predict_fold<B: Basis>(
    samples: &[&SampleOf<B>],
    whole: &WrenchModel<B>,
    fold: &Fold,
) -> Vec<(usize, Predicted)> {
    let train = fold.train(samples.len());
    let train: Vec<_> = train.into_iter().map(|row| samples[row]).collect();
    let axes: Vec<_> = whole.axes.iter().map(|model| model.axis).collect();
    // Without enough data, nothing is predicted.
    let Ok(model) = learn(&train, &axes, Some(whole.novelty.terms)) else {
        return Vec::new();
    };
    let held = fold.held.iter();
    held.map(|&row| (row, Predicted::new(&model, &axes, &samples[row].seen)))
        .collect()
}
