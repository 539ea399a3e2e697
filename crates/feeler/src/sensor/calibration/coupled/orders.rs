//! Chooses the number of terms of each force of a coupled calibration by five-fold cross-validation.
//!
//! A polynomial with more terms than the loads determine fits their noise, which shows in the prediction of loads
//! excluded from the fit.

use super::{
    Loads, NORMAL_ORDERS, Orders, SHEAR_ORDERS, normal_terms, polynomial, shear_terms, solve,
};
use crate::sensor::calibration::least_squares::MIN_SLOPE_RANGE;
use crate::sensor::calibration::relative_moments::RelativeMoments;
use crate::sensor::image::folds::Folds;
use glam::DVec3;

/// Minimum relative reduction of the cross-validated error for which a model with more terms is chosen.
const WORTHWHILE: f64 = 0.02;

/// Chooses the numbers of terms with the best prediction of loads excluded from the fit. A larger number must improve
/// it by more than [`WORTHWHILE`].
///
/// # Errors
/// If there are too few loads, or too few different ones, for the smallest model.
pub(in crate::sensor) fn choose_orders(
    inputs: &[RelativeMoments],
    forces: &[DVec3],
    folds: &Folds,
) -> Result<Orders, String> {
    let largest = |input: fn(&RelativeMoments) -> f64| {
        let largest = inputs
            .iter()
            .map(input)
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        largest.max(MIN_SLOPE_RANGE)
    };
    let scales = [
        largest(|i| i.growth),
        largest(|i| i.displacement.x),
        largest(|i| i.displacement.y),
    ];
    let Loads {
        scaled,
        swapped,
        x,
        y,
        z,
    } = Loads::new(inputs, forces, scales);
    Ok([
        choose_order(&scaled, shear_terms, SHEAR_ORDERS, &x, folds)?,
        choose_order(&swapped, shear_terms, SHEAR_ORDERS, &y, folds)?,
        choose_order(&scaled, normal_terms, NORMAL_ORDERS, &z, folds)?,
    ])
}

fn choose_order<const N: usize>(
    inputs: &[[f64; 3]],
    terms: fn([f64; 3]) -> [f64; N],
    orders: [usize; 4],
    forces: &[f64],
    folds: &Folds,
) -> Result<usize, String> {
    let squares = |order| -> Result<f64, String> {
        let mut squares = 0.0;
        for fold in folds.all() {
            let (train, test) = (folds.others(fold), folds.own(fold));
            let train_inputs: Vec<_> = train.iter().map(|&row| inputs[row]).collect();
            let train_forces: Vec<_> = train.iter().map(|&row| forces[row]).collect();
            let coefficients = solve(&train_inputs, terms, order, &train_forces)?;
            for row in test {
                let error = polynomial(&coefficients, &terms(inputs[row])) - forces[row];
                squares += error * error;
            }
        }
        Ok(squares)
    };
    let mut best = (orders[0], squares(orders[0])?);
    // Models that the loads do not determine are skipped.
    for (order, squares) in orders[1..]
        .iter()
        .filter_map(|&n| Some((n, squares(n).ok()?)))
    {
        if squares.sqrt() < (1.0 - WORTHWHILE) * best.1.sqrt() {
            best = (order, squares);
        }
    }
    Ok(best.0)
}
