//! Novelty detection: distance between an image and those of the calibration.
//!
//! Probabilistic principal component analysis (Tipping and Bishop, J. R. Stat. Soc. B 61, 1999): features vary along
//! few principal directions, each with its own variance, and with a common variance in all others. The distance is the
//! Mahalanobis distance divided by its root mean square:
//!
//! ```text
//! d² = (sum_k t_k² / v_k + (|z|² - sum_k t_k²) / s²) / p
//! ```

use super::basis::{Basis, matrix};
use super::moments::Terms;
use nalgebra::{DMatrix, SymmetricEigen};
use serde::{Deserialize, Serialize};

/// Minimum fraction of the variance that the principal directions must explain.
const PART: f64 = 0.95;
/// Maximum number of principal directions.
pub(super) const MAX_DIRECTIONS: usize = 12;
/// Quantile of the distances of the calibration's images from those of other blocks of time, from which
/// [`Novelty::limit`] is computed. Not the maximum, because a few images are far from all others.
pub(super) const NEAR: f64 = 0.9;
/// Ratio of [`Novelty::limit`] to the distance at the quantile [`NEAR`].
pub(super) const MARGIN: f64 = 1.25;
/// Minimum variance of a direction, relative to 1 for standardised features; smaller ones are rounding errors.
const MIN_VARIANCE: f64 = 1e-6;

/// Distribution of the features in the images of the calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Novelty<T = Terms> {
    /// Regression terms whose distribution is modelled ([`Basis::novelty_terms`]).
    pub terms: T,
    /// Distance up to which an image counts as similar to those of the calibration: 1.25 times the 90 % quantile of the
    /// distances between the calibration's images and those of other blocks of time.
    pub limit: f64,
    /// Variance in each direction orthogonal to the principal ones.
    pub rest: f64,
    /// Principal directions.
    pub directions: Vec<Direction>,
}

/// Principal direction with its variance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Direction {
    /// Variance along the direction.
    pub variance: f64,
    /// Unit vector, with one number per term.
    pub along: Vec<f64>,
}

impl<T: Copy> Novelty<T> {
    /// Fits the distribution of `terms` to all `features`, whose mean must be 0. The caller sets the limit.
    pub(super) fn learn<B: Basis<Terms = T>>(basis: &B, features: &[Vec<f64>], terms: T) -> Self {
        let rows: Vec<_> = (0..features.len()).collect();
        let mut looked_at = matrix(basis, features, &rows, terms);
        looked_at /= (rows.len().max(1) as f64).sqrt();
        let (count, dimensions) = looked_at.shape();
        let total = looked_at.norm_squared();
        let most = (count / 3).min(dimensions / 2).min(MAX_DIRECTIONS);
        let directions = principal(&looked_at, PART * total, most);
        let principal: f64 = directions.iter().map(|direction| direction.variance).sum();
        let others = (dimensions - directions.len()).max(1) as f64;
        Self {
            terms,
            limit: f64::INFINITY,
            rest: ((total - principal) / others).max(MIN_VARIANCE),
            directions,
        }
    }

    /// Distance of standardised `features` from the calibration's distribution; about 1 for its own images. Neither
    /// allocates nor panics.
    pub fn distance<B: Basis<Terms = T>>(&self, basis: &B, features: &[f64]) -> f64 {
        let values = basis.terms(self.terms, features);
        let (mut total, mut count) = (0.0, 0.0_f64);
        for value in values {
            total += value * value;
            count += 1.0;
        }
        let mut sum = 0.0;
        for direction in &self.directions {
            let terms = basis.terms(self.terms, features).zip(&direction.along);
            let along: f64 = terms.map(|(value, along)| value * along).sum();
            total -= along * along;
            sum += along * along / direction.variance;
        }
        ((sum + total.max(0.0) / self.rest) / count.max(1.0)).sqrt()
    }
}

/// Directions of largest variance of `rows`, in descending order: the fewest that explain the fraction `variance`, and
/// at most `most`.
pub(super) fn principal(rows: &DMatrix<f64>, variance: f64, most: usize) -> Vec<Direction> {
    let dual = rows.nrows() <= rows.ncols();
    let gram = match dual {
        true => rows * rows.transpose(),
        false => rows.transpose() * rows,
    };
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = SymmetricEigen::new(gram);
    let mut order: Vec<_> = (0..eigenvalues.len()).collect();
    order.sort_by(|&a, &b| eigenvalues[b].total_cmp(&eigenvalues[a]));
    let mut directions: Vec<Direction> = Vec::new();
    let mut explained = 0.0;
    for index in order.into_iter().take(most) {
        let own = eigenvalues[index];
        let enough = explained >= variance;
        if enough || own <= MIN_VARIANCE {
            break;
        }
        let vector = eigenvectors.column(index).into_owned();
        let along = match dual {
            true => rows.tr_mul(&vector) / own.sqrt(),
            false => vector,
        };
        explained += own;
        directions.push(Direction {
            variance: own,
            along: along.iter().copied().collect(),
        });
    }
    directions
}
