//! Estimates the friction coefficient of one finger's contact from sticking and slipping elements.

/// Loss of shear above which an element that was near the friction limit has slipped, in standard deviations of the
/// noise.
const SLIP_NOISES: f64 = 4.0;
/// Fraction of the friction coefficient above which an element counts as near the limit.
const NEAR: f64 = 0.92;
/// Loss of shear, relative to the normal force, above which an element has slipped even if it was not near the friction
/// limit.
const LARGE_LOSS: f64 = 0.2;
/// Valid range of friction coefficients.
const RANGE: (f64, f64) = (0.1, 3.0);
/// Weight of a measured force ratio in the estimated coefficient if the ratio is larger, with or without a slip.
const RISE: f64 = 0.3;
/// Weight of the force ratio at a slip in the estimated coefficient if the ratio is smaller; the slip may be a false
/// alarm.
const FALL: f64 = 0.1;
/// Relative increase of the coefficient while there is no slip (1/s), so that the grip decreases until an element
/// slips.
const GROWTH: f64 = 0.05;

/// Forces on one element in contact at the latest frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Observation {
    /// Ratio of tangential to normal force.
    pub ratio: f64,
    /// Normal force (N).
    pub normal: f64,
    /// Shear lost by slipping since the previous frame (N).
    pub lost: f64,
    /// Standard deviation of the noise of a shear component (N).
    pub noise: f64,
}

/// Friction estimate for the contact of one finger.
#[derive(Debug, Clone)]
pub(super) struct Friction {
    /// Friction coefficient; `None` before the first slip.
    coefficient: Option<f64>,
    /// Ratio of tangential to normal force of each element at the previous frame; `None` if it was not in contact.
    ratios: Vec<Option<f64>>,
    /// `true` if an element slipped in the latest frame.
    slips: bool,
}

impl Friction {
    /// Creates the estimate for a finger of `elements` elements.
    pub fn new(elements: usize) -> Self {
        Self {
            coefficient: None,
            ratios: vec![None; elements],
            slips: false,
        }
    }

    /// Friction coefficient, or `None` before the first slip.
    pub fn coefficient(&self) -> Option<f64> {
        self.coefficient
    }

    /// Returns whether an element slipped in the latest frame.
    pub fn slips(&self) -> bool {
        self.slips
    }

    /// Starts a new frame, `interval` (s) after the previous one.
    pub fn start(&mut self, interval: f64) {
        let slipped = std::mem::take(&mut self.slips);
        if !slipped && let Some(coefficient) = &mut self.coefficient {
            *coefficient *= 1.0 + GROWTH * interval;
        }
    }

    /// Resets the state between strokes, when no element is in contact.
    pub fn rest(&mut self) {
        self.ratios.fill(None);
        self.slips = false;
    }

    /// Adds the observation of an element; `now` is `None` if it is not in contact.
    pub fn add(&mut self, element: usize, now: Option<Observation>) {
        let Some(ratio) = self.ratios.get_mut(element) else {
            return;
        };
        let before = std::mem::replace(ratio, now.map(|now| now.ratio));
        let (Some(before), Some(now)) = (before, now) else {
            return;
        };
        let is_near = self.coefficient.is_none_or(|known| before > NEAR * known);
        if now.lost > SLIP_NOISES * now.noise && (is_near || now.lost > LARGE_LOSS * now.normal) {
            // Use the ratio before the slip: sliding friction is smaller.
            self.learn(before);
            self.slips = true;
        } else if self.coefficient.is_some_and(|known| now.ratio > known) {
            self.learn(now.ratio);
        }
    }

    fn learn(&mut self, ratio: f64) {
        let ratio = ratio.clamp(RANGE.0, RANGE.1);
        let known = self.coefficient.unwrap_or(ratio);
        let weight = if ratio > known { RISE } else { FALL };
        self.coefficient = Some(known + weight * (ratio - known));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn observation(ratio: f64, lost: f64) -> Option<Observation> {
        Some(Observation {
            ratio,
            normal: 0.2,
            lost,
            noise: 0.002,
        })
    }

    /// Processes the frames of one element, 10 ms apart, given as ratio and lost shear (N).
    fn felt(frames: &[(f64, f64)]) -> Friction {
        let mut friction = Friction::new(1);
        for &(ratio, lost) in frames {
            friction.start(0.01);
            friction.add(0, observation(ratio, lost));
        }
        friction
    }

    #[test]
    fn the_first_slip_shows_the_friction_before_it() {
        assert_eq!(felt(&[(0.8, 0.0), (0.9, 0.0)]).coefficient(), None);
        let friction = felt(&[(0.8, 0.0), (0.9, 0.0), (0.6, 0.02)]);
        assert_eq!(friction.coefficient(), Some(0.9));
        assert!(friction.slips());
    }

    #[test]
    fn noise_is_not_a_slip() {
        let friction = felt(&[(0.8, 0.0), (0.9, 0.0), (0.9, 0.007)]);
        assert!(!friction.slips() && friction.coefficient().is_none());
    }

    #[test]
    fn an_element_that_uses_little_friction_slips_only_by_a_large_loss() {
        let known = [(0.9, 0.0), (0.6, 0.02), (0.5, 0.0)];
        assert!(!felt(&[&known[..], &[(0.5, 0.02)]].concat()).slips());
        let friction = felt(&[&known[..], &[(0.2, 0.05)]].concat());
        assert!(friction.slips());
        // A tenth of the difference between 0.9 and 0.5, apart from the growth in a frame without slip.
        let coefficient = friction.coefficient().expect("a coefficient");
        assert!((coefficient - 0.86).abs() < 0.002, "{coefficient}");
    }

    #[test]
    fn a_larger_ratio_without_slip_raises_the_friction() {
        let friction = felt(&[(0.9, 0.0), (0.6, 0.02), (1.0, 0.0)]);
        let coefficient = friction.coefficient().expect("a coefficient");
        assert!((coefficient - 0.93).abs() < 1e-12, "{coefficient}");
    }

    #[test]
    fn the_friction_grows_until_an_element_slips() {
        let mut friction = felt(&[(0.9, 0.0), (0.6, 0.02)]);
        for _ in 0..=100 {
            friction.start(0.01);
        }
        let coefficient = friction.coefficient().expect("a coefficient");
        let grown = 0.9 * (1.0 + 0.01 * GROWTH).powi(100);
        assert!((coefficient - grown).abs() < 1e-12, "{coefficient}");
    }
}
