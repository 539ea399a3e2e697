//! Transfers a calibration to another copy of the sensor with a few presses.
//!
//! Copies of a sensor differ because of manufacturing tolerances of stiffness, magnets or lights, and mounting. Two
//! steps keep the result close to the original unless the presses contradict it:
//!
//! 1. `adjust` fits a gain and an offset of each component and, where products of readings are used, a linear map from the
//!    readings of each taxel to those of the original.
//! 2. `refine` adds a ridge regression of the remaining errors on the regression terms, so that the weights shrink toward
//!    those of the original (Kuzborskij and Orabona, Stability and hypothesis transfer learning, ICML 2013).
//!
//! Penalties are chosen by cross-validation over presses.

mod adjust;
mod data;
mod refine;

use super::basis::{Basis, standardised};
use super::calibration::{CalibrationOf, WrenchModel};
use super::error::WrenchError;
use super::fit::{FitOf, check, explains_nothing, usable};
use super::novelty::{MARGIN, NEAR};
use super::quality::{HeldOut, band_95, judge, quantile};
use super::sample::SampleOf;
use super::validation::Predicted;
use crate::sensor::fingertip::made_for::CalibrationTarget;
use data::PressData;

/// Transfers `source` to the sensor `made_for` with `samples` of that sensor, which must be in order of time within
/// each recording. Omits components that were not measured and, unless `keep_all`, those that are predicted no better
/// than by the mean. `recordings` contains the names of the recordings.
///
/// The errors in the result are measured on held-out presses, for which everything is fitted again.
///
/// # Errors
/// If the sensors have different numbers of elements, if there are fewer than three presses, or if no component of the
/// source was measured often enough, or can be predicted.
pub fn transfer<B: Basis>(
    source: &CalibrationOf<B>,
    made_for: CalibrationTarget,
    recordings: &[String],
    samples: &[SampleOf<B>],
    keep_all: bool,
) -> Result<FitOf<B>, WrenchError> {
    source.check()?;
    check(&made_for, recordings, samples)?;
    if source.made_for.elements != made_for.elements {
        return Err(WrenchError::Count {
            what: "elements of the calibration to transfer".into(),
            expected: made_for.elements,
            actual: source.made_for.elements,
        });
    }
    let mut samples: Vec<&SampleOf<B>> = samples.iter().collect();
    samples.sort_by_key(|sample| sample.recording);
    let usable = usable(made_for.elements, &samples);
    let unusable = samples.len() - usable.len();
    let data = PressData::new(usable)?;
    let mut model = transferred(source, &data, None);
    let predicted = predict_held_out(source, &data);
    let distances: Vec<f64> = predicted.iter().map(|p| p.distance).collect();
    let near = quantile(distances, NEAR).unwrap_or(0.0);
    let limit = source.model.novelty.limit.max(MARGIN * near);
    model.novelty.limit = limit;
    let (mut quality, mut held_out, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    for (place, original) in source.model.axes.iter().enumerate() {
        let axis = original.axis;
        let rows = data.samples.iter().zip(&predicted);
        let rows = rows.filter_map(|(sample, predicted)| {
            Some(HeldOut {
                recording: sample.recording,
                measured: sample.wrench[axis.index()]?,
                by_blocks: predicted.values[place],
                by_recording: None,
                distance_by_blocks: Some(predicted.distance),
                distance_by_recording: None,
            })
        });
        let rows: Vec<_> = rows.collect();
        let judged = judge(axis, &rows, recordings);
        match judged.filter(|_| model.axes.iter().any(|model| model.axis == axis)) {
            Some(mut judged) if keep_all || judged.explains() => {
                judged.band_95 = band_95(&rows, limit);
                quality.push(judged);
                held_out.push(rows);
            }
            judged => left_out.push((axis, judged.map(|judged| judged.r2))),
        }
    }
    if quality.is_empty() {
        return Err(match left_out.iter().any(|(_, r2)| r2.is_some()) {
            true => explains_nothing(&left_out),
            false => WrenchError::NotMeasured,
        });
    }
    (model.axes).retain(|axis| quality.iter().any(|quality| quality.axis == axis.axis));
    let calibration = CalibrationOf {
        made_for,
        passport: None,
        quality,
        model,
        ..source.clone()
    };
    calibration.check()?;
    Ok(FitOf {
        calibration,
        left_out,
        unusable,
        held_out,
    })
}

/// Transfers the model of `source` using all presses except `held`. Omits components with too few measurements.
fn transferred<B: Basis>(
    source: &CalibrationOf<B>,
    data: &PressData<B>,
    held: Option<usize>,
) -> WrenchModel<B> {
    let mut model = adjust::adjusted(source, data, held);
    let inputs = data.samples.iter().map(|sample| &sample.seen);
    let features = standardised(&model.elements, inputs);
    let axes = model.axes.iter();
    let refined =
        axes.filter_map(|axis| refine::refined(&model.elements, &features, axis, data, held));
    model.axes = refined.collect();
    model
}

/// Predicts each sample with a model that was transferred without the sample's press.
fn predict_held_out<B: Basis>(source: &CalibrationOf<B>, data: &PressData<B>) -> Vec<Predicted> {
    let models: Vec<_> = (0..data.presses)
        .map(|press| transferred(source, data, Some(press)))
        .collect();
    let axes: Vec<_> = source.model.axes.iter().map(|model| model.axis).collect();
    let rows = data.samples.iter().zip(&data.press_of);
    rows.map(|(sample, &press)| Predicted::new(&models[press], &axes, &sample.seen))
        .collect()
}
