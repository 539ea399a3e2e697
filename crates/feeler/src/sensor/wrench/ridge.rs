//! Ridge regression, with fast cross-validation of many penalties.

use super::blocks::Fold;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Fraction of the largest eigenvalue below which an eigenvalue counts as a rounding error.
const MIN_EIGENVALUE: f64 = 1e-12;

/// Eigendecomposition of the centred features: `Z Zᵀ = U diag(d) Uᵀ`.
pub(super) struct Spectrum {
    /// `U`: one row for each sample, one column for each principal direction.
    directions: DMatrix<f64>,
    eigenvalues: Vec<f64>,
}

impl Spectrum {
    /// Centres and decomposes `features` (rows times terms). Uses the smaller of the two Gram matrices, so that the
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

    /// Returns the cross-validation error (predicted minus measured) of each row for each of `penalties`; `None` for
    /// rows that are not held out in any fold and for penalties without a solution. Each prediction is by a regression
    /// on the rows that are not hidden in the fold.
    ///
    /// Exact without refitting: with the hat matrix H of all rows and the residuals r = y - H y, the errors of the
    /// hidden rows S are `-(I - H_SS)⁻¹ r_S` (Cook and Weisberg, Residuals and Influence in Regression, 1982, section
    /// 2.2), which also holds for ridge regression.
    pub fn errors(
        &self,
        measured: &[f64],
        penalties: &[f64],
        folds: &[Fold],
    ) -> Vec<Option<Vec<Option<f64>>>> {
        let rows = measured.len();
        let mean = measured.iter().sum::<f64>() / rows as f64;
        let centred = DVector::from_iterator(rows, measured.iter().map(|value| value - mean));
        let along = self.directions.tr_mul(&centred);
        let fit = |&penalty: &f64| {
            let shares = self
                .eigenvalues
                .iter()
                .map(|value| value / (value + penalty));
            let shares = DVector::from_iterator(self.eigenvalues.len(), shares);
            let residuals = &centred - &self.directions * along.component_mul(&shares);
            (shares.push(1.0), residuals)
        };
        let fits: Vec<_> = penalties.iter().map(fit).collect();
        let mut errors = vec![Some(vec![None; rows]); penalties.len()];
        for fold in folds {
            let hidden = HiddenRows::new(&self.directions, fold);
            for ((shares, residuals), errors) in fits.iter().zip(&mut errors) {
                let own = DVector::from_iterator(
                    fold.hidden.len(),
                    fold.hidden.iter().map(|&row| residuals[row]),
                );
                match (hidden.solve(shares, own), errors.as_mut()) {
                    (Some(solved), Some(errors)) => {
                        let of_hidden = fold.hidden.iter().zip(&hidden.is_held).zip(&solved);
                        for ((&row, _), error) in of_hidden.filter(|((_, held), _)| **held) {
                            errors[row] = Some(-error);
                        }
                    }
                    _ => *errors = None,
                }
            }
        }
        errors
    }
}

/// Hidden rows S of a fold. Their block of the hat matrix is `H_SS = V diag(shares) Vᵀ`, where `V` contains the
/// principal directions of a [`Spectrum`] and a constant column for the mean.
struct HiddenRows {
    directions: DMatrix<f64>,
    /// `Vᵀ V`, for the Woodbury identity; `None` if `V` has at least as many columns as rows.
    gram: Option<DMatrix<f64>>,
    /// `true` for rows that are predicted.
    is_held: Vec<bool>,
}

impl HiddenRows {
    fn new(directions: &DMatrix<f64>, fold: &Fold) -> Self {
        let (rows, count) = directions.shape();
        let mean = 1.0 / (rows as f64).sqrt();
        let own = directions
            .select_rows(&fold.hidden)
            .insert_column(count, mean);
        let gram = (own.ncols() < own.nrows()).then(|| own.tr_mul(&own));
        let mut held = vec![false; rows];
        fold.held.iter().for_each(|&row| held[row] = true);
        Self {
            directions: own,
            gram,
            is_held: fold.hidden.iter().map(|&row| held[row]).collect(),
        }
    }

    /// Solves `(I - V diag(shares) Vᵀ) x = right`, directly or with the Woodbury identity.
    fn solve(&self, shares: &DVector<f64>, right: DVector<f64>) -> Option<DVector<f64>> {
        let own = &self.directions;
        let Some(gram) = &self.gram else {
            let mut scaled = own.transpose();
            for (mut row, share) in scaled.row_iter_mut().zip(shares) {
                row *= *share;
            }
            let left = DMatrix::identity(own.nrows(), own.nrows()) - own * scaled;
            return Some(left.cholesky()?.solve(&right));
        };
        let mut left = -gram;
        for (index, share) in shares.iter().enumerate() {
            left[(index, index)] += 1.0 / share;
        }
        let inner = left.cholesky()?.solve(&own.tr_mul(&right));
        Some(right + own * inner)
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

/// Subtracts the mean from each column. Returns the means of the columns.
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
        // Of each fold, more rows than terms are hidden, or fewer.
        for (rows, terms) in [(40, 7), (40, 20), (23, 60)] {
            let (features, measured) = drawn(rows, terms, 5);
            let folds = blocks(&vec![0; rows], 4);
            let spectrum = Spectrum::new(features.clone());
            let penalties = [1e-2, 1.0, 1e3];
            let all = spectrum.errors(&measured, &penalties, &folds);
            for (penalty, errors) in penalties.into_iter().zip(all) {
                let errors = errors.unwrap();
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
