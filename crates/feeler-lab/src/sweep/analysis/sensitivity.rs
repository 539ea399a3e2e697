//! Variance-based sensitivity indices (Sobol', Mathematics and Computers in Simulation 55, 2001), computed by swapping
//! one factor at a time between two independent rows.
//!
//! Let `f_A`, `f_B` and `f_AB` be the values of `f` for row A, for row B, and for row A with factor `i` from row B,
//! and `V` the variance of `f`.
//!
//! - The first-order index is the fraction of `V` explained by factor `i` alone: the mean of `(f_B - m) (f_AB - f_A)`
//!   divided by `V` (Saltelli et al., Computer Physics Communications 181, 2010). Subtracting the mean `m` reduces
//!   noise without bias.
//! - The total-effect index is the fraction of `V` that remains if all factors except `i` are known, interactions
//!   included: the mean of `(f_A - f_AB)^2 / 2` divided by `V` (Jansen, Computer Physics Communications 117, 1999).
//!
//! If `f` is 0 or 1 (fail or pass), the total-effect index is the probability that swapping only factor `i` changes the
//! result, relative to the probability that swapping everything does.
//!
//! The intervals are bootstrapped over pairs as if the pairs were independent. Points of a Sobol' sequence are more
//! evenly distributed than that, so most intervals are too wide. Indices below 0.005 cannot be resolved.

use super::interval::{Estimate, bootstrap_each};

/// Results of rows A and B, and of row A with one factor from row B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swap {
    /// Result of row A.
    pub a: f64,
    /// Result of row B.
    pub b: f64,
    /// Result of row A with the factor from row B.
    pub ab: f64,
}

/// Sobol' sensitivity indices of one factor, each with its 95 % interval from a percentile bootstrap over pairs of rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Indices {
    /// First-order index.
    pub first: Estimate,
    /// Total-effect index.
    pub total: Estimate,
}

/// Computes the indices of the swapped factor. `None` if there are fewer than two swaps or `f` is constant.
pub fn indices(swaps: &[Swap]) -> Option<Indices> {
    let [first, total] = bootstrap_each(swaps, estimate)?;
    Some(Indices { first, total })
}

/// First-order and total-effect index; NaN if `f` is constant.
fn estimate(swaps: &[&Swap]) -> [f64; 2] {
    let count = swaps.len() as f64;
    let mean = swaps.iter().map(|s| s.a + s.b).sum::<f64>() / (2.0 * count);
    let (mut variance, mut first, mut total) = (0.0, 0.0, 0.0);
    for s in swaps {
        variance += (s.a - mean).powi(2) + (s.b - mean).powi(2);
        first += (s.b - mean) * (s.ab - s.a);
        total += (s.a - s.ab).powi(2);
    }
    let variance = variance / (2.0 * count - 1.0);
    [first / count / variance, 0.5 * total / count / variance]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::plan::design::{Design, Scheme};
    use crate::sweep::plan::ranges::Entry;
    use std::f64::consts::PI;

    /// Computes the indices of every factor of `f`, which takes `count` coordinates from 0 to 1, from `pairs` pairs.
    fn found(f: &dyn Fn(&[f64]) -> f64, count: usize, pairs: u64) -> Vec<Indices> {
        let entry: Entry =
            toml::from_str("name=\"x\"\ngroup=\"g\"\nrange=\"uniform(0,1)\"\nwhy=\"w\"").unwrap();
        let design = Design {
            rows: 2 * pairs,
            controls: 0,
            pairs,
        };
        let scheme = Scheme::new(design, &vec![entry; count]);
        let value = |trial: u64| {
            let (sources, _) = scheme.sources(trial);
            let rows = sources.iter().enumerate();
            let point: Vec<_> = rows
                .map(|(i, row)| scheme.coordinate(row.unwrap(), i, 3))
                .collect();
            f(&point)
        };
        let swaps = |factor: usize| -> Vec<_> {
            let trials = scheme.swaps(factor).map(|trials| trials.map(value));
            trials.map(|[a, b, ab]| Swap { a, b, ab }).collect()
        };
        (0..count)
            .map(|factor| indices(&swaps(factor)).unwrap())
            .collect()
    }

    /// Compares each index with its closed form, and requires it to lie in or near the interval.
    fn near(found: &[Indices], first: &[f64], total: &[f64], tolerance: f64) {
        for (index, found) in found.iter().enumerate() {
            for (estimate, exact) in [(found.first, first[index]), (found.total, total[index])] {
                let error = (estimate.mean - exact).abs();
                assert!(error < tolerance, "{index}: {estimate:?}, expected {exact}");
                // The bootstrap does not model that points of a sequence are not independent. Most of its intervals
                // are too wide therefore, but those of indices near 0 may be off by some thousandths.
                let width = estimate.high - estimate.low;
                assert!(
                    error <= width.max(0.005),
                    "{index}: {estimate:?}, expected {exact}"
                );
            }
        }
    }

    #[test]
    fn ishigami_function_has_known_indices() {
        // f = sin x1 + 7 sin² x2 + 0.1 x3⁴ sin x1 over (-π, π)³; closed form in Saltelli et al., Global Sensitivity
        // Analysis (2008), V = a²/8 + b π⁴/5 + b² π⁸/18 + 1/2.
        let (a, b) = (7.0, 0.1);
        let ishigami = |u: &[f64]| {
            let x: Vec<f64> = u.iter().map(|u| PI * (2.0 * u - 1.0)).collect();
            x[0].sin() + a * x[1].sin().powi(2) + b * x[2].powi(4) * x[0].sin()
        };
        let (p4, p8) = (PI.powi(4), PI.powi(8));
        let v1 = 0.5 * (1.0 + b * p4 / 5.0f64).powi(2);
        let v2 = a * a / 8.0;
        let v13 = b * b * p8 * (1.0 / 18.0 - 1.0 / 50.0);
        let v = v1 + v2 + v13;
        let first = [v1 / v, v2 / v, 0.0];
        let total = [(v1 + v13) / v, v2 / v, v13 / v];
        // Independent draws would have standard errors of up to 0.03 with 2048 pairs; the sequence is more accurate.
        near(&found(&ishigami, 3, 2048), &first, &total, 0.03);
    }

    #[test]
    fn sobol_g_function_has_known_indices() {
        // f = product of (|4 x - 2| + a) / (1 + a); Vi = 1 / (3 (1 + a)²), V = product of (1 + Vi) minus 1.
        let a = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0];
        let g = |u: &[f64]| {
            let factors = u.iter().zip(a);
            factors
                .map(|(u, a)| ((4.0 * u - 2.0).abs() + a) / (1.0 + a))
                .product::<f64>()
        };
        let part = a.map(|a: f64| 1.0 / (3.0 * (1.0 + a).powi(2)));
        let all: f64 = part.iter().map(|v| 1.0 + v).product();
        let first = part.map(|v| v / (all - 1.0));
        let total = part.map(|v| v * all / (1.0 + v) / (all - 1.0));
        near(&found(&g, 8, 2048), &first, &total, 0.03);
    }

    #[test]
    fn a_boolean_function_has_known_indices() {
        // f = (x1 < 1/2 and x2 < 1/2): mean 1/4, V = 3/16. Given x1, the mean is 1/2 or 0, so Vi = 1/16.
        let both = |u: &[f64]| f64::from(u8::from(u[0] < 0.5 && u[1] < 0.5));
        let third = 1.0 / 3.0;
        near(
            &found(&both, 3, 1024),
            &[third, third, 0.0],
            &[2.0 * third, 2.0 * third, 0.0],
            0.03,
        );
    }

    #[test]
    fn a_constant_has_no_indices() {
        let same = Swap {
            a: 1.0,
            b: 1.0,
            ab: 1.0,
        };
        assert_eq!(indices(&[same; 8]), None);
        assert_eq!(indices(&[]), None);
    }
}
