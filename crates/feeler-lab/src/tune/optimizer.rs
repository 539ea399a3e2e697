//! Separable CMA-ES: an evolution strategy that adapts the step size and the variance of each coordinate.
//!
//! After Ros and Hansen, "A Simple Modification in CMA-ES Achieving Linear Time and Space Complexity" (PPSN 2008).
//! Without covariances, the strategy needs no eigenvalues and adapts within the few hundred evaluations available to a
//! search.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// Maximises a noisy function of `N` variables of similar scale.
#[derive(Debug, Clone)]
pub struct Optimizer<const N: usize> {
    /// Mean of the current distribution: the estimate of the optimum.
    pub mean: [f64; N],
    step: f64,
    variance: [f64; N],
    step_path: [f64; N],
    variance_path: [f64; N],
    generation: i32,
    /// Standard normal samples of the current candidates.
    drawn: Vec<[f64; N]>,
    random: Pcg64,
}

/// Constants of the strategy, which depend on the number of variables and candidates.
struct Rates {
    weights: Vec<f64>,
    /// Variance-effective number of parents.
    parents: f64,
    step: f64,
    damping: f64,
    path: f64,
    rank_one: f64,
    rank_mu: f64,
    /// Expected length of a standard normal vector.
    length: f64,
}

impl Rates {
    fn new(n: f64, candidates: usize) -> Self {
        let half = candidates / 2;
        let raw = (0..half).map(|rank| (half as f64 + 0.5).ln() - (rank as f64 + 1.0).ln());
        let raw: Vec<f64> = raw.collect();
        let sum: f64 = raw.iter().sum();
        let weights: Vec<f64> = raw.iter().map(|w| w / sum).collect();
        let parents = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let step = (parents + 2.0) / (n + parents + 5.0);
        // A diagonal matrix has fewer degrees of freedom than a full one and is learned faster.
        let faster = (n + 2.0) / 3.0;
        let rank_one = (2.0 / ((n + 1.3).powi(2) + parents) * faster).min(1.0);
        let rank_mu = 2.0 * (parents - 2.0 + 1.0 / parents) / ((n + 2.0).powi(2) + parents);
        Self {
            parents,
            step,
            damping: 1.0 + step + 2.0 * (((parents - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0),
            path: 4.0 / (n + 4.0),
            rank_one,
            rank_mu: (rank_mu * faster).clamp(0.0, 1.0 - rank_one),
            length: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
            weights,
        }
    }
}

impl<const N: usize> Optimizer<N> {
    /// Starts a search around `mean` with the standard deviation `step` in each variable.
    pub fn new(mean: [f64; N], step: f64, seed: u64) -> Self {
        Self {
            mean,
            step,
            variance: [1.0; N],
            step_path: [0.0; N],
            variance_path: [0.0; N],
            generation: 0,
            drawn: Vec::new(),
            random: Pcg64::seed_from_u64(seed),
        }
    }

    /// Draws the next `count` candidates.
    pub fn ask(&mut self, count: usize) -> Vec<[f64; N]> {
        let Self { random, drawn, .. } = self;
        drawn.clear();
        drawn.extend((0..count).map(|_| std::array::from_fn(|_| random.sample(StandardNormal))));
        let place = |z: &[f64; N]| std::array::from_fn(|i| self.mean[i] + self.scale(i) * z[i]);
        self.drawn.iter().map(place).collect()
    }

    /// Updates the distribution with the `values` of the current candidates (higher is better).
    pub fn tell(&mut self, values: &[f64]) {
        let rates = Rates::new(N as f64, values.len());
        let mut order: Vec<usize> = (0..values.len().min(self.drawn.len())).collect();
        order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
        let best = || order.iter().map(|&index| &self.drawn[index]);
        let weighted = |power: i32, i: usize| -> f64 {
            let parts = rates.weights.iter().zip(best());
            parts.map(|(weight, z)| weight * z[i].powi(power)).sum()
        };
        let shift: [f64; N] = std::array::from_fn(|i| weighted(1, i));
        let squares: [f64; N] = std::array::from_fn(|i| weighted(2, i));
        self.generation += 1;
        let keep = 1.0 - rates.step;
        let gain = (rates.step * (2.0 - rates.step) * rates.parents).sqrt();
        for (i, shift) in shift.iter().enumerate() {
            self.mean[i] += self.scale(i) * shift;
            self.step_path[i] = keep * self.step_path[i] + gain * shift;
        }
        let length = self.step_path.iter().map(|p| p * p).sum::<f64>().sqrt();
        let settled = (1.0 - keep.powi(2 * self.generation)).sqrt();
        let moves = length / settled < (1.4 + 2.0 / (N as f64 + 1.0)) * rates.length;
        let gain =
            f64::from(u8::from(moves)) * (rates.path * (2.0 - rates.path) * rates.parents).sqrt();
        let paths = self.variance_path.iter_mut().zip(&mut self.variance);
        for ((path, variance), (shift, square)) in paths.zip(shift.iter().zip(&squares)) {
            *path = (1.0 - rates.path) * *path + gain * variance.sqrt() * shift;
            *variance = (1.0 - rates.rank_one - rates.rank_mu) * *variance
                + rates.rank_one * *path * *path
                + rates.rank_mu * *variance * square;
        }
        self.step *= ((length / rates.length - 1.0) * rates.step / rates.damping).exp();
    }

    fn scale(&self, i: usize) -> f64 {
        self.step * self.variance[i].sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uses an ellipsoid whose axes differ by a factor of 30.
    #[test]
    fn finds_the_maximum_of_an_ellipsoid() {
        let target = [0.3, -0.2, 0.5, 0.0];
        let value = |x: &[f64; 4]| -> f64 {
            let parts = x.iter().zip(target).zip([1.0, 30.0, 5.0, 100.0]);
            -parts.map(|((x, t), w)| w * (x - t).powi(2)).sum::<f64>()
        };
        let mut optimizer = Optimizer::new([0.0; 4], 0.3, 7);
        for _ in 0..120 {
            let values: Vec<f64> = optimizer.ask(10).iter().map(value).collect();
            optimizer.tell(&values);
        }
        let error = value(&optimizer.mean);
        assert!(error > -1e-6, "{error} {:?}", optimizer.mean);
    }
}
