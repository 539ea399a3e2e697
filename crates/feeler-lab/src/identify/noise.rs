//! Noise of the forces, while nothing touches.

use super::trace::FingerTrace;
use feeler::control::task::probe::Step;

/// Mean and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Best estimate.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// Standard deviation of the noise of one component of an element's force, N; `None` with fewer than ten frames at rest.
///
/// The variance of each component of each element about its mean, averaged over all of them. The spread of these variances gives
/// the standard deviation of the average.
pub fn force_noise(trace: &FingerTrace) -> Option<Measured> {
    let rest: Vec<_> = trace
        .rows
        .iter()
        .filter(|row| row.step == Step::Rest)
        .collect();
    if rest.len() < 10 {
        return None;
    }
    let count = rest.len() as f64;
    let variances: Vec<f64> = (0..trace.layout.elements.len())
        .flat_map(|element| (0..3).map(move |axis| (element, axis)))
        .map(|(element, axis)| {
            let forces = rest.iter().map(|row| row.forces[element][axis]);
            let mean = forces.clone().sum::<f64>() / count;
            forces.map(|force| (force - mean).powi(2)).sum::<f64>() / (count - 1.0)
        })
        .collect();
    let all = variances.len() as f64;
    let mean = variances.iter().sum::<f64>() / all;
    let spread = variances.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (all - 1.0);
    let value = mean.sqrt();
    // d sqrt(v) = dv / (2 sqrt(v)).
    let deviation = (spread / all).sqrt() / (2.0 * value.max(f64::MIN_POSITIVE));
    Some(Measured { value, deviation })
}
