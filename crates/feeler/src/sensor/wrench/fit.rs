//! Fits a wrench calibration to images and measured wrenches.

use super::WrenchAxis;
use super::basis::Basis;
use super::basis::MAX_MISSING;
use super::calibration::CalibrationOf;
use super::error::{VERSION, WrenchError};
use super::learn::{MIN_ROWS, can_be_learned, learn, target};
use super::novelty::MARGIN;
use super::quality::{AxisQuality, HeldOut, band_95};
use super::sample::SampleOf;
use super::validation::validate;
use crate::sensor::fingertip::made_for::CalibrationTarget;

/// Result of fitting a sensor with features `B`.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOf<B: Basis> {
    /// The fitted calibration.
    pub calibration: CalibrationOf<B>,
    /// Measured components that are not calibrated because they cannot be predicted, with their held-out R² (`None` if
    /// there are too few measurements).
    pub left_out: Vec<(WrenchAxis, Option<f64>)>,
    /// Number of images that were not used because too many of their elements are dark or saturated.
    pub unusable: usize,
    /// Held-out predictions of each calibrated component, in the calibration's order.
    pub held_out: Vec<Vec<HeldOut>>,
}

/// Fits a calibration for `made_for` to `samples`, which must be in order of time within each recording. `recordings`
/// contains the names of the recordings. Omits components that cannot be predicted, unless `keep_all`.
///
/// # Errors
/// If there are too few usable samples, if all components are constant, or if no component can be predicted.
pub fn fit<B: Basis>(
    made_for: CalibrationTarget,
    recordings: &[String],
    samples: &[SampleOf<B>],
    keep_all: bool,
) -> Result<FitOf<B>, WrenchError> {
    check(&made_for, recordings, samples)?;
    let mut samples: Vec<&SampleOf<B>> = samples.iter().collect();
    samples.sort_by_key(|sample| sample.recording);
    let lit = usable(made_for.elements, &samples);
    let unusable = samples.len() - lit.len();
    let measured = measured(&lit);
    let changing = changing(&lit, unusable)?;
    let whole = learn(&lit, &changing, None)?;
    let validated = validate(&lit, &whole, recordings);
    let mut qualities: Vec<AxisQuality> = Vec::new();
    let mut held_out = Vec::new();
    let mut left_out = Vec::new();
    for axis in measured {
        match validated.of(axis) {
            Some((quality, predicted)) if keep_all || quality.explains() => {
                qualities.push(quality.clone());
                held_out.push(predicted.to_vec());
            }
            judged => left_out.push((axis, judged.map(|(quality, _)| quality.r2))),
        }
    }
    if qualities.is_empty() {
        return Err(explains_nothing(&left_out));
    }
    let mut model = whole;
    (model.axes).retain(|axis| qualities.iter().any(|quality| quality.axis == axis.axis));
    let limit = MARGIN * validated.near();
    model.novelty.limit = limit;
    for (quality, held_out) in qualities.iter_mut().zip(&held_out) {
        quality.band_95 = band_95(held_out, limit);
    }
    let calibration = CalibrationOf {
        kind: B::KIND.into(),
        version: VERSION,
        loads_confirmed: false,
        tracked: false,
        made_for,
        passport: None,
        quality: qualities,
        model,
    };
    calibration.check()?;
    Ok(FitOf {
        calibration,
        left_out,
        unusable,
        held_out,
    })
}

/// Creates the error for the case that no component can be predicted, with the held-out R² of each.
pub(super) fn explains_nothing(left_out: &[(WrenchAxis, Option<f64>)]) -> WrenchError {
    let name = |(axis, r2): &(WrenchAxis, Option<f64>)| match r2 {
        Some(r2) => format!("{} {r2:.2}", axis.name()),
        None => format!("{} unknown", axis.name()),
    };
    let found = left_out.iter().map(name).collect::<Vec<_>>().join(", ");
    WrenchError::ExplainsNothing { found }
}

/// Rejects samples with a different number of elements, and samples of a recording that has no name.
pub(super) fn check<B: Basis>(
    made_for: &CalibrationTarget,
    recordings: &[String],
    samples: &[SampleOf<B>],
) -> Result<(), WrenchError> {
    let wrong = |what: &str, expected, actual| WrenchError::Count {
        what: what.into(),
        expected,
        actual,
    };
    for sample in samples {
        let (expected, actual) = (made_for.elements, B::elements_of(&sample.seen));
        if expected != actual {
            return Err(wrong("elements of a sample", expected, actual));
        }
        if sample.recording >= recordings.len() {
            let (expected, actual) = (sample.recording + 1, recordings.len());
            return Err(wrong("names of recordings", expected, actual));
        }
    }
    Ok(())
}

/// Samples in which at most [`MAX_MISSING`] of the elements are missing.
pub(super) fn usable<'a, B: Basis>(
    elements: usize,
    samples: &[&'a SampleOf<B>],
) -> Vec<&'a SampleOf<B>> {
    let inputs: Vec<_> = samples.iter().map(|sample| &sample.seen).collect();
    let basis = B::from_inputs(elements, &inputs);
    let mut features = vec![0.0; basis.feature_count()];
    let mut is_lit =
        |sample: &&&SampleOf<B>| basis.standardise(&sample.seen, &mut features) <= MAX_MISSING;
    samples.iter().filter(|s| is_lit(s)).copied().collect()
}

/// Components that were measured in at least one sample.
fn measured<B: Basis>(samples: &[&SampleOf<B>]) -> Vec<WrenchAxis> {
    let all = WrenchAxis::ALL.into_iter();
    let any = |axis: &WrenchAxis| samples.iter().any(|s| s.wrench[axis.index()].is_some());
    all.filter(any).collect()
}

/// Components that were measured often enough and vary.
fn changing<B: Basis>(
    samples: &[&SampleOf<B>],
    unusable: usize,
) -> Result<Vec<WrenchAxis>, WrenchError> {
    let targets = WrenchAxis::ALL.map(|axis| target(samples, axis));
    let most = targets.iter().map(|target| target.rows.len()).max();
    let actual = most.unwrap_or(0);
    if actual < MIN_ROWS {
        let why = match unusable {
            0 => String::new(),
            count => {
                format!(
                    "; in {count} others, over a tenth of the elements are missing, dark or saturated"
                )
            }
        };
        return Err(WrenchError::TooFew {
            expected: MIN_ROWS,
            actual,
            why,
        });
    }
    let changing = targets.into_iter().filter(can_be_learned);
    let changing: Vec<_> = changing.map(|target| target.axis).collect();
    if changing.is_empty() {
        return Err(WrenchError::Constant);
    }
    Ok(changing)
}
