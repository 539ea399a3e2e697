//! Probabilities of slip from the scores of a detector, and their calibration.

use super::outcome::{Known, Labelled, groups_of, known};

/// Number of equal intervals of probability in which predictions are compared with labels.
const BINS: usize = 10;
/// Maximum number of Newton steps of a fit.
const STEPS: usize = 50;
/// Precision (1/variance) of the Gaussian prior of the slope in units of the scores' standard deviations; keeps
/// separable scores from an infinite slope.
const PRIOR: f64 = 0.1;

/// Probabilities of slip, cross-validated over groups.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrated {
    /// w0 and w1 of p = 1 / (1 + exp(-(w0 + w1 score))), fitted to all samples.
    pub weights: [f64; 2],
    /// Expected calibration error: mean difference between predicted and observed fraction of slips in intervals of
    /// probability 0.1 wide, weighted by the number of samples. Each probability is predicted with weights fitted to
    /// all other groups.
    pub error: f64,
    /// Intervals with samples: mean predicted probability, observed fraction of slips, number of samples.
    pub bins: Vec<(f64, f64, usize)>,
}

/// Fits probabilities to scores by logistic regression (Platt, "Probabilistic outputs for support vector machines",
/// 1999, without its change of the labels). Returns `None` for a single group or if labels are all equal.
pub fn calibrate(samples: &[Labelled]) -> Option<Calibrated> {
    let known = known(samples);
    let groups = groups_of(&known);
    let is_slip = |k: &Known| k.slip;
    if groups.len() < 2 || known.iter().all(is_slip) || !known.iter().any(is_slip) {
        return None;
    }
    let mut bins = [(0.0, 0, 0_usize); BINS];
    for &group in &groups {
        let [constant, slope] = fit(known.iter().filter(|k| k.group != group));
        for own in known.iter().filter(|k| k.group == group) {
            let probability = sigmoid(constant + slope * own.score);
            let bin = &mut bins[((probability * BINS as f64) as usize).min(BINS - 1)];
            bin.0 += probability;
            bin.1 += usize::from(own.slip);
            bin.2 += 1;
        }
    }
    let apart = |&(sum, slips, _): &(f64, usize, usize)| (sum - slips as f64).abs();
    let full = bins.iter().filter(|bin| bin.2 > 0);
    let mean = |&(sum, slips, count): &(f64, usize, usize)| {
        (sum / count as f64, slips as f64 / count as f64, count)
    };
    Some(Calibrated {
        weights: fit(known.iter()),
        error: bins.iter().map(apart).sum::<f64>() / known.len() as f64,
        bins: full.map(mean).collect(),
    })
}

fn sigmoid(logit: f64) -> f64 {
    1.0 / (1.0 + (-logit).exp())
}

/// Weights with the highest posterior probability, by Newton's method with halved steps.
fn fit<'a>(known: impl Iterator<Item = &'a Known> + Clone) -> [f64; 2] {
    let count = known.clone().count().max(1) as f64;
    let mean = known.clone().map(|k| k.score).sum::<f64>() / count;
    let squares = known.clone().map(|k| (k.score - mean).powi(2)).sum::<f64>();
    let deviation = (squares / count).sqrt().max(f64::MIN_POSITIVE);
    let scaled = |k: &Known| ((k.score - mean) / deviation, f64::from(u8::from(k.slip)));
    let loss = |[a, b]: [f64; 2]| {
        let one = |k: &Known| {
            let (x, slip) = scaled(k);
            let logit = a + b * x;
            logit.max(0.0) - slip * logit + (-logit.abs()).exp().ln_1p()
        };
        known.clone().map(one).sum::<f64>() + 0.5 * PRIOR * b * b
    };
    let mut weights = [0.0; 2];
    for _ in 0..STEPS {
        let [a, b] = weights;
        let (mut g, mut h) = ([0.0, PRIOR * b], [1e-9, 0.0, PRIOR]);
        for k in known.clone() {
            let (x, slip) = scaled(k);
            let p = sigmoid(a + b * x);
            let (off, w) = (p - slip, p * (1.0 - p));
            g = [g[0] + off, g[1] + off * x];
            h = [h[0] + w, h[1] + w * x, h[2] + w * x * x];
        }
        let det = h[0] * h[2] - h[1] * h[1];
        let step = [
            (h[2] * g[0] - h[1] * g[1]) / det,
            (h[0] * g[1] - h[1] * g[0]) / det,
        ];
        let before = loss(weights);
        let mut part = 1.0;
        let mut next = weights;
        while part > 1e-6 {
            next = [a - part * step[0], b - part * step[1]];
            if loss(next) < before {
                break;
            }
            (part, next) = (0.5 * part, weights);
        }
        if next == weights {
            break;
        }
        weights = next;
    }
    let slope = weights[1] / deviation;
    [weights[0] - slope * mean, slope]
}

#[cfg(test)]
mod tests {
    use super::super::outcome::samples;
    use super::*;

    /// Scores 0 and 1 with a quarter and three quarters of slips: the exact weights are -ln 3 and 2 ln 3, up to the
    /// prior's pull, and the predictions of the other groups agree with the labels.
    #[test]
    fn probabilities_are_fractions_of_slips() {
        let mut rows = Vec::new();
        for group in 0..200 {
            let ones = |score: f64, slips: usize| (0..4).map(move |i| (group, i < slips, score));
            rows.extend(ones(0.0, 1).chain(ones(1.0, 3)));
        }
        let calibrated = calibrate(&samples(&rows)).unwrap();
        let [constant, slope] = calibrated.weights;
        assert!((constant + 3.0_f64.ln()).abs() < 2e-3, "{constant}");
        assert!((slope - 2.0 * 3.0_f64.ln()).abs() < 4e-3, "{slope}");
        assert!(calibrated.error < 1e-3);
        let [low, high] = calibrated.bins.as_slice() else {
            panic!("two bins")
        };
        assert_eq!((low.1, low.2, high.1, high.2), (0.25, 800, 0.75, 800));
    }

    /// Each group contradicts the other: a score that means slip in one does not in the other.
    #[test]
    fn contradictory_groups_are_badly_calibrated() {
        let rows = [
            (0, true, 9.0),
            (0, false, 0.0),
            (1, true, 0.0),
            (1, false, 9.0),
        ];
        assert!(calibrate(&samples(&rows)).unwrap().error > 0.8);
        assert_eq!(
            calibrate(&samples(&[(0, true, 9.0), (0, false, 0.0)])),
            None
        );
        assert_eq!(calibrate(&samples(&[(0, true, 9.0), (1, true, 0.0)])), None);
        let equal = calibrate(&samples(&[(0, true, 1.0), (1, false, 1.0)])).unwrap();
        assert!(equal.weights.iter().all(|weight| weight.is_finite()));
    }
}
