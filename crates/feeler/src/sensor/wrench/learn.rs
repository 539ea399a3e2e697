//! Fits the model of a wrench calibration: statistics, terms, penalties, weights and novelty.

use super::WrenchAxis;
use super::basis::{Basis, matrix, standardised};
use super::calibration::{AxisModel, WrenchModel};
use super::choice::{Target, choose};
use super::error::WrenchError;
use super::novelty::Novelty;
use super::ridge::regress;
use super::sample::{SampleOf, recording_of};

/// Minimum number of samples to fit a component.
pub(super) const MIN_ROWS: usize = 10;

/// Returns `true` if a component was measured often enough and varies.
pub(super) fn can_be_learned(target: &Target) -> bool {
    let changes = target.measured.windows(2).any(|pair| pair[0] != pair[1]);
    changes && target.rows.len() >= MIN_ROWS
}

pub(super) fn target<B: Basis>(samples: &[&SampleOf<B>], axis: WrenchAxis) -> Target {
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
/// measurements. The novelty model uses the terms `watched` or, if `None`, [`Basis::novelty_terms`]; its limit is not
/// set.
pub(super) fn learn<B: Basis>(
    samples: &[&SampleOf<B>],
    axes: &[WrenchAxis],
    watched: Option<B::Terms>,
) -> Result<WrenchModel<B>, WrenchError> {
    let elements = samples
        .first()
        .map_or(0, |sample| B::elements_of(&sample.seen));
    let inputs: Vec<_> = samples.iter().map(|sample| &sample.seen).collect();
    let basis = B::from_inputs(elements, &inputs);
    let features = standardised(&basis, inputs.iter().copied());
    let targets = axes.iter().map(|&axis| target(samples, axis));
    let targets: Vec<_> = targets.filter(can_be_learned).collect();
    let choices = choose(&basis, &features, &recording_of(samples), &targets);
    let mut models = Vec::new();
    for (target, choice) in targets.iter().zip(choices) {
        let axis = target.axis;
        let unsolvable = WrenchError::Unsolvable { axis: axis.name() };
        let Some(choice) = choice else {
            return Err(unsolvable);
        };
        let rows = matrix(&basis, &features, &target.rows, choice.terms);
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
    let chosen: Vec<_> = models.iter().map(|model| model.terms).collect();
    let watched = watched.unwrap_or_else(|| basis.novelty_terms(&chosen));
    let novelty = Novelty::learn(&basis, &features, watched);
    let mut elements = basis;
    elements.keep_only(&chosen);
    Ok(WrenchModel {
        novelty,
        axes: models,
        elements,
    })
}
