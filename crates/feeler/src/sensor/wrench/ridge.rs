//! Ridge regression, with fast cross-validation for many penalties.

use super::blocks::Fold;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Eigenvalues below this fraction of the largest are rounding errors.
const MIN_EIGENVALUE: f64 = 1e-12;

/// Eigendecomposition of the centred features: `Z Zᵀ = U diag(d) Uᵀ`.
pub(super) struct Spectrum {
    /// `U`: one row for each row of features, one column for each direction.
    directions: DMatrix<f64>,
    eigenvalues: Vec<f64>,
}

impl Spectrum {
    /// Decomposes `features` (rows times terms) after centring. Uses the smaller of the two Gram matrices, so that the
    /// cost is bounded by the number of rows even for many terms.
    pub fn new(mut features: DMatrix<f64>) -> Self {
        centre(&mut features);
        let (rows, terms) = features.shape();
        let dual = rows <= terms;
        let gram = match dual {
            true => &features * features.transpose(),
            false => features.transpose() * &features,
        };
        let SymmetricEigen {
            eigenvectors,
            eigenvalues,
        } = SymmetricEigen::new(gram);
        let least = MIN_EIGENVALUE * eigenvalues.max().max(0.0);
        let kept: Vec<_> = (0..eigenvalues.len())
            .filter(|&index| eigenvalues[index] > least)
            .collect();
        let mut directions = eigenvectors.select_columns(&kept);
        let eigenvalues: Vec<_> = kept.iter().map(|&index| eigenvalues[index]).collect();
        if !dual {
            directions = features * directions;
            for (mut column, value) in directions.column_iter_mut().zip(&eigenvalues) {
                column /= value.sqrt();
            }
        }
        Self {
            directions,
            eigenvalues,
        }
    }

    /// Returns the cross-validation error (predicted minus measured) of each row, or `None` for rows that no fold holds
    /// out. Each prediction comes from a regression on the rows that the fold does not hide.
    ///
    /// Exact without refitting: with the hat matrix H of all rows and the residuals r = y - H y, the errors of the
    /// hidden rows S are `-(I - H_SS)⁻¹ r_S` (Cook and Weisberg, Residuals and Influence in Regression, 1982, section
    /// 2.2), which also holds for ridge regression.
    pub fn errors(
        &self,
        measured: &[f64],
        penalty: f64,
        folds: &[Fold],
    ) -> Option<Vec<Option<f64>>> {
        let rows = measured.len();
        let mean = measured.iter().sum::<f64>() / rows as f64;
        let centred = DVector::from_iterator(rows, measured.iter().map(|value| value - mean));
        let along = self.directions.tr_mul(&centred);
        let shares = self
            .eigenvalues
            .iter()
            .map(|value| value / (value + penalty));
        let shares = DVector::from_iterator(self.eigenvalues.len(), shares);
        let residuals = &centred - &self.directions * along.component_mul(&shares);
        let mut errors = vec![None; rows];
        for fold in folds {
            let own = self.directions.select_rows(&fold.hidden);
            let mut scaled = own.clone();
            for (mut column, share) in scaled.column_iter_mut().zip(&shares) {
                column *= *share;
            }
            let hat = scaled * own.transpose();
            let size = fold.hidden.len();
            let left = DMatrix::identity(size, size) - hat.add_scalar(1.0 / rows as f64);
            let right = DVector::from_iterator(size, fold.hidden.iter().map(|&row| residuals[row]));
            let solved = left.lu().solve(&right)?;
            for (&row, error) in fold.hidden.iter().zip(&solved) {
                if fold.held.contains(&row) {
                    errors[row] = Some(-error);
                }
            }
        }
        Some(errors)
    }
}

/// Ridge regression of `measured` on `features` (rows times terms). Returns intercept and weights.
pub(super) fn regress(
    mut features: DMatrix<f64>,
    measured: &[f64],
    penalty: f64,
) -> Option<(f64, Vec<f64>)> {
    let means = centre(&mut features);
    let (rows, terms) = features.shape();
    let mean = measured.iter().sum::<f64>() / rows.max(1) as f64;
    let centred = DVector::from_iterator(rows, measured.iter().map(|value| value - mean));
    let ridge = |size| DMatrix::from_diagonal_element(size, size, penalty);
    let weights = if rows <= terms {
        let gram = &features * features.transpose() + ridge(rows);
        features.tr_mul(&gram.cholesky()?.solve(&centred))
    } else {
        let gram = features.transpose() * &features + ridge(terms);
        gram.cholesky()?.solve(&features.tr_mul(&centred))
    };
    let intercept = mean - weights.dot(&means);
    let finite = intercept.is_finite() && weights.iter().all(|weight| weight.is_finite());
    finite.then(|| (intercept, weights.iter().copied().collect()))
}

/// Subtracts the mean from each column. Returns the means.
fn centre(features: &mut DMatrix<f64>) -> DVector<f64> {
    let rows = features.nrows().max(1) as f64;
    let means: Vec<f64> = features
        .column_iter()
        .map(|column| column.sum() / rows)
        .collect();
    for (mut column, mean) in features.column_iter_mut().zip(&means) {
        column.add_scalar_mut(-mean);
    }
    DVector::from_vec(means)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::wrench::blocks::blocks;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    fn drawn(rows: usize, terms: usize, seed: u64) -> (DMatrix<f64>, Vec<f64>) {
        let mut random = Pcg64::seed_from_u64(seed);
        let features = DMatrix::from_fn(rows, terms, |_, _| random.random_range(-1.0..1.0));
        let measured = (0..rows).map(|row| {
            3.0 + features[(row, 0)] - 2.0 * features[(row, 1)] + random.random_range(-0.1..0.1)
        });
        let measured = measured.collect();
        (features, measured)
    }

    /// The closed form equals refitting without the held-out rows, with more and with fewer terms than rows.
    #[test]
    fn errors_equal_those_of_refitting_without_the_rows() {
        for (rows, terms) in [(40, 7), (23, 60)] {
            let (features, measured) = drawn(rows, terms, 5);
            let folds = blocks(&vec![0; rows], 4);
            let spectrum = Spectrum::new(features.clone());
            for penalty in [1e-2, 1.0, 1e3] {
                let errors = spectrum.errors(&measured, penalty, &folds).unwrap();
                for fold in &folds {
                    let train = fold.train(rows);
                    let own: Vec<_> = train.iter().map(|&row| measured[row]).collect();
                    let (intercept, weights) =
                        regress(features.select_rows(&train), &own, penalty).unwrap();
                    for &row in &fold.held {
                        let terms = features.row(row).transpose();
                        let predicted = intercept + terms.dot(&DVector::from_row_slice(&weights));
                        let error = predicted - measured[row];
                        assert!((errors[row].unwrap() - error).abs() < 1e-8, "{error}");
                    }
                }
            }
        }
    }

    /// With little penalty and noise, recovers the weights that generated the data. Noise of 0.1 over 400 rows gives an
    /// error of about 0.005 in a weight (0.1 / sqrt(3) over sqrt(400 / 3)).
    #[test]
    fn recovers_the_weights() {
        let (features, measured) = drawn(400, 3, 7);
        let (intercept, weights) = regress(features, &measured, 1e-9).unwrap();
        for (found, law) in [intercept, weights[0], weights[1], weights[2]]
            .into_iter()
            .zip([3.0, 1.0, -2.0, 0.0])
        {
            assert!((found - law).abs() < 0.025, "{found} for {law}");
        }
    }
}
