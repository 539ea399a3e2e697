//! Eigenvalues of `J J^T`, the squares of the Jacobian's singular values.

use glam::{DMat3, DVec3};

/// Maximum number of sweeps of Jacobi's method, which converges quadratically: five suffice for 3 x 3 matrices.
const SWEEPS: usize = 10;

/// Eigenvalues and eigenvectors of a symmetric, positive semi-definite matrix.
pub(super) struct Spectrum {
    /// Eigenvalues in descending order, at least 0.
    pub(super) values: [f64; 3],
    /// Orthonormal eigenvectors, in the same order.
    pub(super) vectors: [DVec3; 3],
}

impl Spectrum {
    /// Decomposes `matrix` by Jacobi's method. The absolute error of the eigenvalues is a rounding error of the largest
    /// one. A NaN in `matrix` makes the result NaN.
    pub(super) fn of(matrix: &DMat3) -> Self {
        let mut a = [[0.0; 3]; 3];
        for (row, values) in a.iter_mut().enumerate() {
            *values = matrix.row(row).to_array();
        }
        let mut vectors = [DVec3::X, DVec3::Y, DVec3::Z];
        for _ in 0..SWEEPS {
            if a[0][1] == 0.0 && a[0][2] == 0.0 && a[1][2] == 0.0 {
                break;
            }
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                rotate(&mut a, &mut vectors, p, q);
            }
        }
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| a[j][j].total_cmp(&a[i][i]));
        Self {
            values: order.map(|i| if a[i][i] < 0.0 { 0.0 } else { a[i][i] }),
            vectors: order.map(|i| vectors[i]),
        }
    }

    /// Solution y of `(matrix + damping^2 I) y = b` in the span of the first `rank` eigenvectors.
    pub(super) fn solve(&self, rank: usize, damping: f64, b: DVec3) -> DVec3 {
        let pairs = self.values.iter().zip(&self.vectors).take(rank);
        pairs.fold(DVec3::ZERO, |sum, (value, vector)| {
            sum + *vector * (vector.dot(b) / (value + damping * damping))
        })
    }
}

/// Applies the Jacobi rotation that zeroes `a[p][q]` (Golub and Van Loan, Matrix Computations, section 8.5).
fn rotate(a: &mut [[f64; 3]; 3], vectors: &mut [DVec3; 3], p: usize, q: usize) {
    let (app, aqq, apq) = (a[p][p], a[q][q], a[p][q]);
    // Below rounding of both diagonal entries the rotation has no effect on the eigenvalues.
    if apq.abs() <= 0.01 * f64::EPSILON * (app * aqq).abs().sqrt() {
        (a[p][q], a[q][p]) = (0.0, 0.0);
        return;
    }
    let tau = (aqq - app) / (2.0 * apq);
    let t = 1.0_f64.copysign(tau) / (tau.abs() + (1.0 + tau * tau).sqrt());
    let c = 1.0 / (1.0 + t * t).sqrt();
    let s = t * c;
    let r = 3 - p - q;
    let (arp, arq) = (a[r][p], a[r][q]);
    a[p][p] = app - t * apq;
    a[q][q] = aqq + t * apq;
    (a[p][q], a[q][p]) = (0.0, 0.0);
    a[r][p] = c * arp - s * arq;
    a[r][q] = s * arp + c * arq;
    (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
    let (vp, vq) = (vectors[p], vectors[q]);
    vectors[p] = vp * c - vq * s;
    vectors[q] = vp * s + vq * c;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Products `sum c c^T` of pseudo-random columns, some of them of rank 1 or 2, and of extreme scales.
    fn matrices() -> impl Iterator<Item = DMat3> {
        (0..3000).map(|i| {
            let at = |k: i32| (f64::from(i * 7 + k) * 1.618).sin();
            let columns = [0, 3, 6].map(|k| DVec3::new(at(k), at(k + 1), at(k + 2)));
            let scale = 10.0_f64.powi(i % 60 - 30);
            let count = i as usize % 3 + 1;
            columns
                .into_iter()
                .take(count)
                .map(|c| DMat3::from_cols(c * c.x, c * c.y, c * c.z) * scale)
                .fold(DMat3::ZERO, |sum, matrix| sum + matrix)
        })
    }

    #[test]
    fn eigenvalues_are_those_of_nalgebra() {
        for matrix in matrices() {
            let spectrum = Spectrum::of(&matrix);
            let nalgebra = nalgebra::Matrix3::from_column_slice(&matrix.to_cols_array());
            let mut expected = nalgebra.symmetric_eigenvalues().as_slice().to_vec();
            expected.sort_by(|a, b| b.total_cmp(a));
            for (own, other) in spectrum.values.into_iter().zip(expected) {
                // Both have rounding errors of the largest eigenvalue.
                assert!((own - other).abs() <= 1e-15 * 3.0 * spectrum.values[0]);
            }
        }
    }

    #[test]
    fn eigenvectors_are_orthonormal_and_solve_the_damped_system() {
        for matrix in matrices() {
            let spectrum = Spectrum::of(&matrix);
            let v = DMat3::from_cols_array_2d(&spectrum.vectors.map(|v| v.to_array()));
            let difference = (v.transpose() * v - DMat3::IDENTITY).abs().to_cols_array();
            // About 15 rotations, each with a rounding error of 2.2e-16.
            assert!(
                difference.into_iter().fold(0.0, f64::max) < 3.4e-15,
                "{difference:?}"
            );
            let b = DVec3::new(0.3, -0.8, 0.5);
            let damping = (0.1 * spectrum.values[0]).sqrt();
            let y = spectrum.solve(3, damping, b);
            let back = matrix * y + y * (damping * damping);
            // Condition number 11.
            assert!(back.abs_diff_eq(b, 1e-14), "{back}");
        }
    }

    #[test]
    fn nan_is_not_hidden() {
        let mut matrix = DMat3::IDENTITY;
        matrix.y_axis.x = f64::NAN;
        matrix.x_axis.y = f64::NAN;
        assert!(Spectrum::of(&matrix).solve(3, 0.1, DVec3::ONE).is_nan());
    }
}
