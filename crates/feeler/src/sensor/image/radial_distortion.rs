//! Radial lens distortion.

/// Maximum number of iterations: twice the digits of an `f64`, and as many again for a bracket of 2^64.
const MAX_STEPS: usize = 256;

/// Radial distortion `r -> r (1 + k1 r^2 + k2 r^4)` of the slope `r` (tangent of the angle between ray and optical
/// axis), used where it is increasing.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::sensor) struct RadialDistortion {
    k1: f64,
    k2: f64,
    /// Slope at which the distorted radius stops increasing; infinite if it always increases.
    fold: f64,
}

impl RadialDistortion {
    /// Creates a distortion with the coefficients `k1` and `k2`.
    pub(in crate::sensor) fn new(k1: f64, k2: f64) -> Self {
        // The smallest positive root s = r^2 of 1 + 3 k1 s + 5 k2 s^2, as 2c / (-b + sqrt(..)).
        let discriminant = 9.0 * k1 * k1 - 20.0 * k2;
        let divisor = -3.0 * k1 + discriminant.max(0.0).sqrt();
        let folds = discriminant >= 0.0 && divisor > 0.0;
        let fold = if folds {
            (2.0 / divisor).sqrt()
        } else {
            f64::INFINITY
        };
        Self { k1, k2, fold }
    }

    /// Ratio of distorted to undistorted radius of a ray with slope `r`; `None` beyond the increasing part.
    pub(in crate::sensor) fn scale(&self, r: f64) -> Option<f64> {
        let s = r * r;
        (r < self.fold).then_some(1.0 + s * (self.k1 + s * self.k2))
    }

    /// Ratio of distorted to undistorted radius at the distorted radius `distorted`.
    ///
    /// `None` if no ray is imaged at that radius, or the iteration does not converge.
    pub(in crate::sensor) fn inverse_scale(&self, distorted: f64) -> Option<f64> {
        if (self.k1 == 0.0 && self.k2 == 0.0) || distorted == 0.0 {
            return Some(1.0);
        }
        let (mut low, mut high) = (0.0, self.bracket(distorted)?);
        let mut r = distorted.min(high);
        let mut last_step = high;
        // Newton steps, each less than half of the last one. Otherwise the bracket is bisected, because Newton steps
        // are slow along a fifth power far from its root.
        for _ in 0..MAX_STEPS {
            let s = r * r;
            let error = r * (1.0 + s * (self.k1 + s * self.k2)) - distorted;
            if error > 0.0 {
                high = r;
            } else {
                low = r;
            }
            let newton = r - error / (1.0 + s * (3.0 * self.k1 + s * 5.0 * self.k2));
            let fast = (newton - r).abs() < 0.5 * last_step;
            let next = if fast && newton >= low && newton <= high {
                newton
            } else {
                0.5 * (low + high)
            };
            last_step = (next - r).abs();
            r = next;
            if last_step <= 4.0 * f64::EPSILON * r {
                return Some(distorted / r);
            }
        }
        None
    }

    /// Upper bound of the undistorted slope: a slope whose distorted radius is at least `distorted`. `None` if there is
    /// no such slope.
    fn bracket(&self, distorted: f64) -> Option<f64> {
        let radius = |r: f64| r * (1.0 + r * r * (self.k1 + r * r * self.k2));
        if self.fold.is_finite() {
            return (radius(self.fold) > distorted).then_some(self.fold);
        }
        (0..64)
            .map(|doubling| distorted * f64::powi(2.0, doubling))
            .find(|&r| radius(r) >= distorted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round trip over all valid slopes, up to nearly a right angle, where Newton steps alone would be slow.
    #[test]
    fn scales_are_inverted_however_oblique_the_ray() {
        for (k1, k2) in [
            (0.0, 0.011),
            (0.1, 0.0),
            (0.1, 0.02),
            (-0.1, 0.02),
            (-0.1, -0.02),
            (0.0, -0.01),
        ] {
            let lens = RadialDistortion::new(k1, k2);
            for decade in -6..=6 {
                let r = 1.8 * f64::powi(10.0, decade);
                let Some(scale) = lens.scale(r) else {
                    continue;
                };
                let inverse = lens.inverse_scale(r * scale);
                // Near the maximum of the distorted radius, where the function is flat, half of the digits are lost.
                let error = inverse.map(|inverse| (inverse / scale - 1.0).abs());
                assert!(
                    error.is_some_and(|error| error < 1e-7),
                    "k {k1} {k2}, slope {r}: {inverse:?}, expected {scale}"
                );
            }
        }
    }
}
