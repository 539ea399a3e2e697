//! Noise of the forces without contact.

use super::trace::FingerTrace;
use feeler::control::task::probe::Step;

/// A measured value with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Best estimate.
    pub value: f64,
    /// Standard deviation of the estimate.
    pub deviation: f64,
}

/// Standard deviation of the noise of one component of an element's force (N). `None` if there are fewer than ten
/// frames at rest.
///
/// The variances of all components of all elements about their means are averaged. The spread of the variances gives
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

#[cfg(test)]
mod tests {
    use super::super::trace::Row;
    use super::*;
    use feeler::control::FingertipPose;
    use feeler::hand::JointVector;
    use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
    use glam::DVec3;

    fn trace(rows: usize) -> FingerTrace {
        let layout = ElementLayout::new(&LayoutConfig::default());
        let row = |index: usize| {
            let noise = if index.is_multiple_of(2) {
                0.003
            } else {
                -0.003
            };
            Row {
                time: 0.01 * index as f64,
                step: Step::Rest,
                place: 0,
                command: JointVector::zeros(3),
                joints: JointVector::zeros(3),
                pose: FingertipPose::default(),
                // The different offsets of the elements do not count as noise.
                forces: (0..layout.elements.len())
                    .map(|element| DVec3::splat(noise + 0.1 * element as f64))
                    .collect(),
            }
        };
        FingerTrace {
            rows: (0..rows).map(row).collect(),
            layout: layout.clone(),
            approach: DVec3::X,
            axis: DVec3::Z,
        }
    }

    #[test]
    fn noise_is_relative_to_each_elements_mean() {
        let noise = force_noise(&trace(100)).expect("a noise");
        // All values deviate by 3 mN; the unbiased variance of 100 samples is 100/99 of 3 mN squared.
        assert!((noise.value - 0.003 * (100.0_f64 / 99.0).sqrt()).abs() < 1e-12);
        assert!(noise.deviation < 1e-12, "{noise:?}");
    }

    #[test]
    fn few_frames_give_no_estimate() {
        assert_eq!(force_noise(&trace(9)), None);
    }
}
