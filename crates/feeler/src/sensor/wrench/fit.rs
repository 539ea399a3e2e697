//! Fits a wrench calibration to images and measured wrenches.

use super::blocks::recording_of;
use super::calibration::{AxisModel, KIND, VERSION, WrenchCalibration, WrenchModel};
use super::choice::{Target, choose, matrix};
use super::error::WrenchError;
use super::features::{Growth, MIN_FOR_GAIN, PER_ELEMENT, Terms, standardise, standards};
use super::novelty::{MARGIN, Novelty};
use super::quality::{AxisQuality, HeldOut};
use super::ridge::regress;
use super::validation::validate;
use super::{MeasuredWrench, WrenchAxis};
use crate::sensor::fingertip::made_for::CalibrationTarget;
use crate::sensor::moments::kernel::ElementMoments;

/// Minimum number of images to fit a component.
pub const MIN_ROWS: usize = 10;
/// Maximum fraction of elements that may be dark or saturated in an image used for fitting or prediction.
pub const MAX_MISSING: f64 = 0.1;

/// One image and the wrench measured at the same time.
#[derive(Debug, Clone, PartialEq)]
pub struct WrenchSample {
    /// Index of the recording.
    pub recording: usize,
    /// Moments of each element; `None` if it is dark or saturated.
    pub seen: Vec<Option<ElementMoments>>,
    /// Measured wrench.
    pub wrench: MeasuredWrench,
}

/// Result of fitting.
#[derive(Debug, Clone, PartialEq)]
pub struct WrenchFit {
    /// The calibration.
    pub calibration: WrenchCalibration,
    /// Measured components that are omitted because the calibration does not predict them, with their held-out R²
    /// (`None` if there are too few measurements).
    pub left_out: Vec<(WrenchAxis, Option<f64>)>,
    /// Number of images that were not used because too many of their elements are dark or saturated.
    pub unusable: usize,
    /// Held-out predictions for each component of the calibration, in its order.
    pub held_out: Vec<Vec<HeldOut>>,
}

/// Fits a calibration for `made_for` to `samples`, which must be in order of time within each recording. `recordings`
/// contains the names of the recordings. Omits components that cannot be predicted, unless `keep_all`.
///
/// # Errors
/// If there are too few usable samples, if all components are constant, or if no component can be predicted.
pub fn fit(
    made_for: CalibrationTarget,
    recordings: &[String],
    samples: &[WrenchSample],
    keep_all: bool,
) -> Result<WrenchFit, WrenchError> {
    check(&made_for, recordings, samples)?;
    let mut samples: Vec<&WrenchSample> = samples.iter().collect();
    samples.sort_by_key(|sample| sample.recording);
    let lit = lit(made_for.elements, &samples);
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
        let name = |(axis, r2): &(WrenchAxis, Option<f64>)| match r2 {
            Some(r2) => format!("{} {r2:.2}", axis.name()),
            None => format!("{} unknown", axis.name()),
        };
        let found = left_out.iter().map(name).collect::<Vec<_>>().join(", ");
        return Err(WrenchError::ExplainsNothing { found });
    }
    let mut model = whole;
    (model.axes).retain(|axis| qualities.iter().any(|quality| quality.axis == axis.axis));
    model.novelty.limit = MARGIN * validated.near();
    let calibration = WrenchCalibration {
        kind: KIND.into(),
        version: VERSION,
        loads_confirmed: false,
        made_for,
        quality: qualities,
        model,
    };
    calibration.check()?;
    Ok(WrenchFit {
        calibration,
        left_out,
        unusable,
        held_out,
    })
}

/// Rejects samples of another sensor or of a recording without a name.
fn check(
    made_for: &CalibrationTarget,
    recordings: &[String],
    samples: &[WrenchSample],
) -> Result<(), WrenchError> {
    let wrong = |what: &str, expected, actual| WrenchError::Count {
        what: what.into(),
        expected,
        actual,
    };
    for sample in samples {
        if sample.seen.len() != made_for.elements {
            let (expected, actual) = (made_for.elements, sample.seen.len());
            return Err(wrong("elements of a picture", expected, actual));
        }
        if sample.recording >= recordings.len() {
            let (expected, actual) = (sample.recording + 1, recordings.len());
            return Err(wrong("names of recordings", expected, actual));
        }
    }
    Ok(())
}

/// Samples in which at most [`MAX_MISSING`] of the elements are missing.
fn lit<'a>(elements: usize, samples: &[&'a WrenchSample]) -> Vec<&'a WrenchSample> {
    let standards = standards(elements, samples.iter().map(|sample| &sample.seen[..]));
    let mut features = vec![[0.0; PER_ELEMENT]; elements];
    let mut is_lit = |sample: &&&WrenchSample| {
        let seen = sample.seen.iter().copied();
        standardise(&standards, seen, &mut features) <= MAX_MISSING
    };
    samples.iter().filter(|s| is_lit(s)).copied().collect()
}

/// Components that were measured in any sample.
fn measured(samples: &[&WrenchSample]) -> Vec<WrenchAxis> {
    let all = WrenchAxis::ALL.into_iter();
    let any = |axis: &WrenchAxis| samples.iter().any(|s| s.wrench[axis.index()].is_some());
    all.filter(any).collect()
}

/// Components that were measured often enough and are not constant.
fn changing(samples: &[&WrenchSample], unusable: usize) -> Result<Vec<WrenchAxis>, WrenchError> {
    let targets = WrenchAxis::ALL.map(|axis| target(samples, axis));
    let most = targets.iter().map(|target| target.rows.len()).max();
    let actual = most.unwrap_or(0);
    if actual < MIN_ROWS {
        let why = match unusable {
            0 => String::new(),
            count => {
                format!("; in {count} others, over a tenth of the elements are dark or saturated")
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

fn can_be_learned(target: &Target) -> bool {
    let changes = target.measured.windows(2).any(|pair| pair[0] != pair[1]);
    changes && target.rows.len() >= MIN_ROWS
}

fn target(samples: &[&WrenchSample], axis: WrenchAxis) -> Target {
    let measured = samples.iter().map(|sample| sample.wrench[axis.index()]);
    let measured = measured.enumerate();
    let (rows, measured) = measured
        .filter_map(|(row, value)| Some((row, value?)))
        .unzip();
    Target {
        axis,
        rows,
        measured,
    }
}

/// Fits the components `axes` to `samples`, including the choice of terms and penalties. Omits components with too few
/// measurements. The novelty model uses the features `watched`, or by default growth and displacement of all elements;
/// its limit is not set.
pub(super) fn learn(
    samples: &[&WrenchSample],
    axes: &[WrenchAxis],
    watched: Option<Terms>,
) -> Result<WrenchModel, WrenchError> {
    let elements = samples.first().map_or(0, |sample| sample.seen.len());
    let standards = standards(elements, samples.iter().map(|sample| &sample.seen[..]));
    let features = samples.iter().map(|sample| {
        let mut features = vec![[0.0; PER_ELEMENT]; elements];
        standardise(&standards, sample.seen.iter().copied(), &mut features);
        features
    });
    let features: Vec<_> = features.collect();
    let targets = axes.iter().map(|&axis| target(samples, axis));
    let targets: Vec<_> = targets.filter(can_be_learned).collect();
    let used = standards.iter().filter(|standard| standard.used).count();
    let choices = choose(&features, &recording_of(samples), used, &targets);
    let mut models = Vec::new();
    for (target, choice) in targets.iter().zip(choices) {
        let axis = target.axis;
        let unsolvable = WrenchError::Unsolvable { axis: axis.name() };
        let Some(choice) = choice else {
            return Err(unsolvable);
        };
        let rows = matrix(&features, &target.rows, choice.terms);
        let solved = regress(rows, &target.measured, choice.penalty);
        let (intercept, weights) = solved.ok_or(unsolvable)?;
        models.push(AxisModel {
            axis,
            terms: choice.terms,
            penalty: choice.penalty,
            intercept,
            weights,
        });
    }
    let all: Vec<_> = (0..features.len()).collect();
    let watched = watched.unwrap_or_else(|| watched_of(&models, used));
    Ok(WrenchModel {
        novelty: Novelty::learn(&features, &all, watched),
        axes: models,
        elements: standards,
    })
}

/// Features for novelty detection: growth and displacement of each of the `used` elements, independently of the terms
/// of the components. Under an unusual load, spots may brighten as usual but move differently. Overall brightness is
/// included if a component depends on it, or if there are too few elements to separate it from growth.
fn watched_of(models: &[AxisModel], used: usize) -> Terms {
    let plain = models
        .iter()
        .any(|model| model.terms.growth == Growth::Plain);
    Terms {
        growth: match plain || used < MIN_FOR_GAIN {
            true => Growth::Plain,
            false => Growth::GainFree,
        },
        displacement: true,
        squares: false,
    }
}
