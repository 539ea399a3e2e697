//! Corrects a transferred model with a ridge regression of its errors.

use super::data::PressData;
use crate::sensor::wrench::basis::{Basis, matrix};
use crate::sensor::wrench::calibration::AxisModel;
use crate::sensor::wrench::choice::{Shrinkage, best_penalty};
use crate::sensor::wrench::ridge::{Spectrum, regress};

/// Adds a ridge regression of the errors to a component, fitted without the press `held`. Returns `None` if there are
/// too few measurements of the component. `features` contains the features of all samples.
pub(super) fn refined<B: Basis>(
    basis: &B,
    features: &[Vec<f64>],
    original: &AxisModel<B::Terms>,
    data: &PressData<B>,
    held: Option<usize>,
) -> Option<AxisModel<B::Terms>> {
    let target = data.target(original.axis, held)?;
    let rows = target.rows.iter().zip(&target.measured);
    let errors = rows.map(|(&row, measured)| measured - original.value(basis, &features[row]));
    let errors: Vec<f64> = errors.collect();
    let design = |rows: &[usize]| matrix(basis, features, rows, original.terms);
    let step = errors.len().div_ceil(B::MAX_ROWS).max(1);
    let kept: Vec<_> = target.rows.iter().copied().step_by(step).collect();
    let kept_errors: Vec<_> = errors.iter().copied().step_by(step).collect();
    let spectrum = Spectrum::new(design(&kept));
    let chosen = best_penalty(
        &spectrum,
        &kept_errors,
        original.terms,
        &[data.folds(&kept)],
        Shrinkage::Strong,
    )?;
    let penalty = chosen.penalty * step as f64;
    let (intercept, changes) = regress(design(&target.rows), &errors, penalty)?;
    let weights = changes.iter().zip(&original.weights);
    Some(AxisModel {
        axis: original.axis,
        terms: original.terms,
        penalty,
        intercept: original.intercept + intercept,
        weights: weights.map(|(change, weight)| weight + change).collect(),
    })
}
