//! Linear equations of a ridge regression.

use nalgebra::{Cholesky, DMatrix};
use std::ops::Range;

/// A form of the ridge regression problem.
pub trait Problem {
    fn measured(&self) -> &DMatrix<f64>;
    /// Solves without the rows `held` (held out); `None` if there is no solution.
    fn solve(&self, held: Range<usize>, penalty: f64) -> Option<DMatrix<f64>>;
    fn predict(&self, rows: Range<usize>, solution: &DMatrix<f64>) -> DMatrix<f64>;
    fn predict_test(&self, solution: &DMatrix<f64>) -> DMatrix<f64>;
}

/// Primal form: normal equations with one unknown per feature. The last feature is constant and not penalised.
pub struct Primal {
    x: DMatrix<f64>,
    test: DMatrix<f64>,
    y: DMatrix<f64>,
    gram: DMatrix<f64>,
    right: DMatrix<f64>,
}

impl Primal {
    pub fn new(x: DMatrix<f64>, test: DMatrix<f64>, y: DMatrix<f64>) -> Self {
        let constant = |x: DMatrix<f64>| {
            let end = x.ncols();
            x.insert_column(end, 1.0)
        };
        let (x, test) = (constant(x), constant(test));
        Self {
            gram: x.tr_mul(&x),
            right: x.tr_mul(&y),
            x,
            test,
            y,
        }
    }
}

impl Problem for Primal {
    fn measured(&self) -> &DMatrix<f64> {
        &self.y
    }

    fn solve(&self, held: Range<usize>, penalty: f64) -> Option<DMatrix<f64>> {
        let (x, y) = (
            self.x.rows_range(held.clone()),
            self.y.rows_range(held.clone()),
        );
        let mut gram = &self.gram - x.tr_mul(&x);
        let right = &self.right - x.tr_mul(&y);
        let rows = (self.x.nrows() - held.len()) as f64;
        for feature in 0..gram.nrows().saturating_sub(1) {
            gram[(feature, feature)] += penalty * rows;
        }
        Some(Cholesky::new(gram)?.solve(&right))
    }

    fn predict(&self, rows: Range<usize>, solution: &DMatrix<f64>) -> DMatrix<f64> {
        self.x.rows_range(rows) * solution
    }

    fn predict_test(&self, solution: &DMatrix<f64>) -> DMatrix<f64> {
        &self.test * solution
    }
}

/// Dual form: one unknown per training row, used if there are more features than rows. The kernel includes the
/// constant.
pub struct Dual {
    kernel: DMatrix<f64>,
    test: DMatrix<f64>,
    y: DMatrix<f64>,
}

impl Dual {
    pub fn new(x: &DMatrix<f64>, test: &DMatrix<f64>, y: DMatrix<f64>, products: bool) -> Self {
        let power = if products { 2 } else { 1 };
        let kernel =
            |a: &DMatrix<f64>| (a * x.transpose()).map(|product| (1.0 + product).powi(power));
        Self {
            kernel: kernel(x),
            test: kernel(test),
            y,
        }
    }
}

impl Problem for Dual {
    fn measured(&self) -> &DMatrix<f64> {
        &self.y
    }

    /// Weights of all rows; those of `held` are 0.
    fn solve(&self, held: Range<usize>, penalty: f64) -> Option<DMatrix<f64>> {
        let kept: Vec<_> = (0..self.y.nrows())
            .filter(|row| !held.contains(row))
            .collect();
        let mut gram = self.kernel.select_rows(&kept).select_columns(&kept);
        for row in 0..kept.len() {
            gram[(row, row)] += penalty * kept.len() as f64;
        }
        let solved = Cholesky::new(gram)?.solve(&self.y.select_rows(&kept));
        let mut weights = DMatrix::zeros(self.y.nrows(), self.y.ncols());
        for (from, &row) in kept.iter().enumerate() {
            weights.set_row(row, &solved.row(from));
        }
        Some(weights)
    }

    fn predict(&self, rows: Range<usize>, solution: &DMatrix<f64>) -> DMatrix<f64> {
        self.kernel.rows_range(rows) * solution
    }

    fn predict_test(&self, solution: &DMatrix<f64>) -> DMatrix<f64> {
        &self.test * solution
    }
}
