//! A lens that bends rays the more, the farther they are off its axis.

/// `r -> r (1 + k1 r^2 + k2 r^4)`, used as far as it grows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RadialDistortion {
    k1: f64,
    k2: f64,
    /// Slope up to which the distorted radius grows, infinite if it always does.
    fold: f64,
}

impl RadialDistortion {
    /// The lens with these coefficients.
    pub(super) fn new(k1: f64, k2: f64) -> Self {
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

    /// Distorted over undistorted radius at slope `r`.
    pub(super) fn scale(&self, r: f64) -> Option<f64> {
        let s = r * r;
        (r < self.fold).then_some(1.0 + s * (self.k1 + s * self.k2))
    }

    /// Distorted over undistorted radius where the distorted radius is `distorted`.
    pub(super) fn inverse_scale(&self, distorted: f64) -> Option<f64> {
        if (self.k1 == 0.0 && self.k2 == 0.0) || distorted == 0.0 {
            return Some(1.0);
        }
        let (mut low, mut high) = (0.0, self.bracket(distorted)?);
        let mut r = distorted.min(high);
        // Newton's steps, halving where a step leaves the bracket; 60 halvings exhaust an f64.
        for _ in 0..60 {
            let s = r * r;
            let error = r * (1.0 + s * (self.k1 + s * self.k2)) - distorted;
            if error > 0.0 {
                high = r;
            } else {
                low = r;
            }
            let newton = r - error / (1.0 + s * (3.0 * self.k1 + s * 5.0 * self.k2));
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            if (next - r).abs() <= 1e-15 * r {
                break;
            }
            r = next;
        }
        Some(distorted / r)
    }

    /// A slope that is seen no nearer to the centre than `distorted`.
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
