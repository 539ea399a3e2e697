//! Fits the model of a wrench calibration: standards, terms, penalties, weights and novelty.

use super::WrenchAxis;
use super::calibration::{AxisModel, WrenchModel};
use super::choice::{Target, choose};
use super::error::WrenchError;
use super::features::{Growth, MIN_FOR_GAIN, PER_ELEMENT, Terms, matrix, standardise, standards};
use super::novelty::Novelty;
use super::ridge::regress;
use super::sample::{WrenchSample, recording_of};

/// Minimum number of images to fit a component.
pub(super) const MIN_ROWS: usize = 10;

/// Returns `true` if a component was measured often enough and is not constant.
pub(super) fn can_be_learned(target: &Target) -> bool {
    let changes = target.measured.windows(2).any(|pair| pair[0] != pair[1]);
    changes && target.rows.len() >= MIN_ROWS
}

pub(super) fn target(samples: &[&WrenchSample], axis: WrenchAxis) -> Target {
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
