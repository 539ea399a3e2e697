//! Smoothing before peaks are counted, and before torque rate and shear rate are compared.

use feeler_record::RunFacts;

/// Length of the moving mean (s).
pub const SMOOTHING: f64 = 0.05;

/// Odd number of control steps closest to [`SMOOTHING`], at least 1.
pub fn smoothing_window(facts: &RunFacts) -> usize {
    let samples = (SMOOTHING / facts.control_period).round().clamp(1.0, 1e6) as usize;
    samples | 1
}
