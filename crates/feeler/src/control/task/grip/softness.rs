//! Estimates the softness of an object from the force on the most compressed columnar feelers while the gripper closes.

use crate::control::feeler_shape::FeelerShape;

/// Force on the most compressed feeler of each finger from which the measurement starts (N).
pub(super) const START_FORCE: f64 = 0.04;
/// Minimum closing distance of all fingers together for an estimate of the stiffness (m).
const LEAST_DISTANCE: f64 = 1e-4;
/// Valid range of the relative stiffness.
const PLAUSIBLE: (f64, f64) = (0.15, 1.0);

/// Estimates the stiffness of feeler and object in series, relative to that of the feeler. Uses the most compressed
/// feeler, because a finger's entire closing distance compresses it, while the number of feelers in contact changes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Softness {
    feeler: FeelerShape,
    /// Closing distance of all fingers together (m), and sum of the largest forces (N), when the measurement started.
    start: Option<(f64, f64)>,
    /// Stiffness of feeler and object in series, relative to that of the feeler; 1 on a rigid object.
    share: f64,
}

impl Softness {
    /// Creates the estimate for a rigid object.
    pub fn new(feeler: FeelerShape) -> Self {
        Self {
            feeler,
            start: None,
            share: 1.0,
        }
    }

    /// Updates the relative stiffness with the sum of the forces on the most compressed feelers (N), at the closing
    /// distance `closed` of all fingers together (m).
    pub fn update(&mut self, closed: f64, force: f64) {
        let (from, before) = *self.start.get_or_insert((closed, force));
        if closed - from > LEAST_DISTANCE {
            let share = (force - before) / (self.feeler.normal_stiffness * (closed - from));
            self.share = share.clamp(PLAUSIBLE.0, PLAUSIBLE.1);
        }
    }

    /// Properties of a feeler that is equivalent to feeler and object in series.
    pub fn in_series(&self) -> FeelerShape {
        FeelerShape {
            normal_stiffness: self.share * self.feeler.normal_stiffness,
            shear_stiffness: self.share * self.feeler.shear_stiffness,
            ..self.feeler
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn softness() -> Softness {
        Softness::new(FeelerShape {
            normal_stiffness: 400.0,
            ..FeelerShape::default()
        })
    }

    #[test]
    fn an_object_as_soft_as_the_feelers_halves_the_stiffness() {
        let mut softness = softness();
        for step in 0..20 {
            let closed = 0.02 + 2e-5 * f64::from(step);
            softness.update(closed, 0.1 + 200.0 * (closed - 0.02));
        }
        let stiffness = softness.in_series().normal_stiffness;
        assert!((stiffness - 200.0).abs() < 1e-9, "{stiffness}");
    }

    #[test]
    fn impossible_forces_give_a_plausible_stiffness() {
        let mut softness = softness();
        softness.update(0.02, 0.1);
        softness.update(0.021, 5.0);
        assert_eq!(softness.share, PLAUSIBLE.1);
        softness.update(0.021, 0.0);
        assert_eq!(softness.share, PLAUSIBLE.0);
    }
}
