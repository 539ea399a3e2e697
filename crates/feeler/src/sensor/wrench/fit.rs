//! A wrench calibration from pictures and what was measured under them.

use super::blocks::recording_of;
use super::calibration::{AxisModel, KIND, VERSION, WrenchCalibration, WrenchModel};
use super::choice::{Target, choose, matrix};
use super::error::WrenchError;
use super::features::{Growth, LEAST_FOR_GAIN, PER_ELEMENT, Terms, standardise, standards};
use super::novelty::{MARGIN, Novelty};
use super::quality::{AxisQuality, HeldOut};
use super::ridge::regress;
use super::validation::validate;
use super::{MeasuredWrench, WrenchAxis};
use crate::sensor::made_for::MadeFor;
use crate::sensor::moments::ElementMoments;

/// Least number of pictures to learn a component from.
pub const LEAST_ROWS: usize = 10;
/// Largest part of the elements that may be dark or saturated in a picture that is learned from, or predicted of.
pub const MOST_MISSING: f64 = 0.1;

/// One picture and the wrench under which it was taken.
#[derive(Debug, Clone, PartialEq)]
pub struct WrenchSample {
    /// Index of the recording that it is part of.
    pub recording: usize,
    /// Moments of each element; none of one that is dark or saturated.
    pub seen: Vec<Option<ElementMoments>>,
    /// What was measured.
    pub wrench: MeasuredWrench,
}

/// What came of fitting.
#[derive(Debug, Clone, PartialEq)]
pub struct WrenchFit {
    /// The calibration.
    pub calibration: WrenchCalibration,
    /// Components that were measured and are not in the calibration, as it explains nothing of them, with their R² on data that was
    /// not seen (none where too little was measured to tell).
    pub left_out: Vec<(WrenchAxis, Option<f64>)>,
    /// Pictures that were not learned from, as too many of their elements are dark or saturated.
    pub unusable: usize,
    /// For each component of the calibration, in its order, what was predicted of each picture in which it was measured.
    pub held_out: Vec<Vec<HeldOut>>,
}

/// Fits a calibration of what it is `made_for` to `samples`, which are in the order of time within each of the recordings called
/// `recordings`. Components of which nothing is explained are left out, unless `keep_all`.
///
/// # Errors
/// When there are too few usable samples, nothing changes, or no component is explained.
pub fn fit(
    made_for: MadeFor,
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

/// Refuses samples of another sensor, or of a recording without a name.
fn check(
    made_for: &MadeFor,
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

/// The samples of whose elements few are missing.
fn lit<'a>(elements: usize, samples: &[&'a WrenchSample]) -> Vec<&'a WrenchSample> {
    let standards = standards(elements, samples.iter().map(|sample| &sample.seen[..]));
    let mut features = vec![[0.0; PER_ELEMENT]; elements];
    let mut is_lit = |sample: &&&WrenchSample| {
        let seen = sample.seen.iter().copied();
        standardise(&standards, seen, &mut features) <= MOST_MISSING
    };
    samples.iter().filter(|s| is_lit(s)).copied().collect()
}

/// The components that were measured at all.
fn measured(samples: &[&WrenchSample]) -> Vec<WrenchAxis> {
    let all = WrenchAxis::ALL.into_iter();
    let any = |axis: &WrenchAxis| samples.iter().any(|s| s.wrench[axis.index()].is_some());
    all.filter(any).collect()
}

/// The components that were measured often enough, and change.
fn changing(samples: &[&WrenchSample], unusable: usize) -> Result<Vec<WrenchAxis>, WrenchError> {
    let targets = WrenchAxis::ALL.map(|axis| target(samples, axis));
    let most = targets.iter().map(|target| target.rows.len()).max();
    let actual = most.unwrap_or(0);
    if actual < LEAST_ROWS {
        let why = match unusable {
            0 => String::new(),
            count => {
                format!("; in {count} more, over a tenth of the elements are dark or saturated")
            }
        };
        return Err(WrenchError::TooFew {
            expected: LEAST_ROWS,
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
    changes && target.rows.len() >= LEAST_ROWS
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

/// Learns `axes` from `samples`, terms and penalties included; those that were measured too seldom in them are not in the model.
/// Novelty is learned of the features `watched`, or else of growth and displacement of all elements; its limit is left open.
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

/// What is looked at to tell another kind of load: growth and displacement of each of the `used` elements, whatever the components follow
/// from. Under a load of another kind, spots may brighten as usual and move as they never did. Overall brightness is looked at where a
/// component follows from it, or where there are too few elements to tell it from growth.
fn watched_of(models: &[AxisModel], used: usize) -> Terms {
    let plain = models
        .iter()
        .any(|model| model.terms.growth == Growth::Plain);
    Terms {
        growth: match plain || used < LEAST_FOR_GAIN {
            true => Growth::Plain,
            false => Growth::GainFree,
        },
        displacement: true,
        squares: false,
    }
}
