//! Baseline: ridge regression on the values of a row, with or without their products.

mod equations;

use equations::{Dual, Primal, Problem};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Number of contiguous blocks of the training rows for choosing the penalty.
const FOLDS: usize = 4;
/// Exponents of the candidate penalties 10^n, for kernels whose mean square is about 1.
const PENALTIES: std::ops::RangeInclusive<i32> = -7..=1;
/// Maximum number of features for which the primal form is solved; above it, the dual form is.
const MAX_FEATURES: usize = 600;

/// Predicts targets of `test` rows from `train` rows with measured `targets` (NaN if unknown). `products` also uses the
/// products of all pairs of values. Missing values are replaced by their mean.
pub fn predict(
    train: &[&[f64]],
    targets: &[&[f64]],
    test: &[&[f64]],
    products: bool,
) -> Vec<Vec<f64>> {
    let count = targets.first().map_or(0, |targets| targets.len());
    let mut predicted = vec![vec![f64::NAN; count]; test.len()];
    // Targets measured in the same rows share the decompositions.
    let mut by_rows: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    (0..count).for_each(|target| {
        let rows = (0..train.len()).filter(|&row| targets[row][target].is_finite());
        by_rows.entry(rows.collect()).or_default().push(target);
    });
    for (rows, own) in by_rows {
        if rows.is_empty() {
            continue;
        }
        let y = DMatrix::from_fn(rows.len(), own.len(), |row, column| {
            targets[rows[row]][own[column]]
        });
        let train: Vec<_> = rows.iter().map(|&row| train[row]).collect();
        let found = regress(&Standard::of(&train), &train, &y, test, products);
        for (row, predicted) in predicted.iter_mut().enumerate() {
            for (column, &target) in own.iter().enumerate() {
                predicted[target] = found[(row, column)];
            }
        }
    }
    predicted
}

/// Mean and inverse standard deviation of each value; the latter is 0 for constant values.
struct Standard(Vec<(f64, f64)>);

impl Standard {
    fn of(rows: &[&[f64]]) -> Self {
        let values = rows.iter().map(|row| row.len()).max().unwrap_or(0);
        let of_value = |value: usize| {
            let known = rows.iter().filter_map(|row| row.get(value).copied());
            let known: Vec<_> = known.filter(|value| value.is_finite()).collect();
            let count = known.len().max(1) as f64;
            let mean = known.iter().sum::<f64>() / count;
            let variance = known
                .iter()
                .map(|value| (value - mean).powi(2))
                .sum::<f64>()
                / count;
            let deviation = variance.sqrt();
            (
                mean,
                if deviation > 1e-12 * mean.abs() {
                    1.0 / deviation
                } else {
                    0.0
                },
            )
        };
        Self((0..values).map(of_value).collect())
    }

    /// Standardises rows, and divides them by the square root of the number of values, so that their norm is about 1.
    fn apply(&self, rows: &[&[f64]]) -> DMatrix<f64> {
        let root = (self.0.len().max(1) as f64).sqrt();
        DMatrix::from_fn(rows.len(), self.0.len(), |row, column| {
            let (mean, scale) = self.0[column];
            let value = rows[row].get(column).copied().unwrap_or(f64::NAN);
            if value.is_finite() {
                (value - mean) * scale / root
            } else {
                0.0
            }
        })
    }
}

fn regress(
    standard: &Standard,
    train: &[&[f64]],
    y: &DMatrix<f64>,
    test: &[&[f64]],
    products: bool,
) -> DMatrix<f64> {
    let (x, z) = (standard.apply(train), standard.apply(test));
    let values = x.ncols();
    let features = if products {
        values + values * (values + 1) / 2
    } else {
        values
    };
    let means = DVector::from_iterator(y.ncols(), y.column_iter().map(|column| column.mean()));
    let mut centred = y.clone();
    for (mut column, mean) in centred.column_iter_mut().zip(&means) {
        column.add_scalar_mut(-mean);
    }
    let problem: &dyn Problem = if features <= MAX_FEATURES {
        &Primal::new(explicit(&x, products), explicit(&z, products), centred)
    } else {
        &Dual::new(&x, &z, centred, products)
    };
    let error = |exponent: i32| (cross_validated(problem, 10_f64.powi(exponent)), exponent);
    let best = PENALTIES.map(error).min_by(|a, b| a.0.total_cmp(&b.0));
    let penalty = 10_f64.powi(best.map_or(0, |(_, exponent)| exponent));
    let found = problem
        .solve(0..0, penalty)
        .map(|solution| problem.predict_test(&solution));
    let mut found = found.unwrap_or_else(|| DMatrix::zeros(z.nrows(), y.ncols()));
    for (mut column, mean) in found.column_iter_mut().zip(&means) {
        column.add_scalar_mut(*mean);
    }
    found
}

/// Returns the features of the kernel: `(1 + x·z)² - 1` with products, `x·z` without.
fn explicit(x: &DMatrix<f64>, products: bool) -> DMatrix<f64> {
    if !products {
        return x.clone();
    }
    let (values, root) = (x.ncols(), 2_f64.sqrt());
    let linear = x.column_iter().map(|column| column * root);
    let pairs = (0..values).flat_map(|a| (a..values).map(move |b| (a, b)));
    let products = pairs.map(|(a, b)| {
        let product = x.column(a).component_mul(&x.column(b));
        if a == b { product } else { product * root }
    });
    let columns: Vec<_> = linear.chain(products).collect();
    DMatrix::from_columns(&columns)
}

/// Sum of squared errors over all folds, each target relative to its variance.
fn cross_validated(problem: &dyn Problem, penalty: f64) -> f64 {
    let y = problem.measured();
    let scales: Vec<_> = y
        .column_iter()
        .map(|c| c.norm_squared().max(f64::MIN_POSITIVE))
        .collect();
    let fold = |fold: usize| {
        let bound = |fold: usize| fold * y.nrows() / FOLDS;
        let held = bound(fold)..bound(fold + 1);
        let Some(solution) = problem.solve(held.clone(), penalty) else {
            return f64::INFINITY;
        };
        let difference = problem.predict(held.clone(), &solution) - y.rows_range(held);
        let columns = difference.column_iter().zip(&scales);
        columns
            .map(|(column, scale)| column.norm_squared() / scale)
            .sum::<f64>()
    };
    (0..FOLDS).map(fold).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Products recover y = 3 + a - 2 b c exactly in both forms; values alone leave the product unexplained, whose mean
    /// square is 4/9 for factors that are uniform from -1 to 1.
    #[test]
    fn products_are_recovered() {
        let wave = |row: usize, step: f64| ((row as f64 * step).fract() - 0.5) * 2.0;
        let rows = (0..400).map(|row| {
            let mut values = vec![
                wave(row, 0.618_034),
                wave(row, 0.414_214),
                wave(row, 0.732_051),
            ];
            values.push(4.0); // constant
            values
        });
        let rows: Vec<Vec<f64>> = rows.collect();
        let y: Vec<_> = rows
            .iter()
            .map(|v| vec![3.0 + v[0] - 2.0 * v[1] * v[2]])
            .collect();
        let wide: Vec<Vec<f64>> = rows
            .iter()
            .map(|v| v.iter().cycle().take(160).copied().collect())
            .collect();
        for rows in [&rows, &wide] {
            let slices: Vec<_> = rows.iter().map(Vec::as_slice).collect();
            let targets: Vec<_> = y.iter().map(Vec::as_slice).collect();
            let error = |products| {
                let found = predict(&slices[..300], &targets[..300], &slices[300..], products);
                let pairs = found.iter().zip(&y[300..]);
                pairs.map(|(a, b)| (a[0] - b[0]).powi(2)).sum::<f64>() / 100.0
            };
            assert!(error(true) < 1e-6, "{}", error(true));
            assert!((0.3..0.6).contains(&error(false)), "{}", error(false));
        }
    }
}
