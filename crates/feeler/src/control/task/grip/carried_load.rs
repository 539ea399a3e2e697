//! Estimates the load of a carried object: its start, its mean and its decrease.

use crate::control::grasp_slip::part;
use glam::DVec3;

/// Time constant of the present load (s).
const PRESENT: f64 = 0.02;
/// Duration after closing during which the shear still decreases (s).
const SETTLING: f64 = 0.2;
/// Time constant of the shear that remains from closing, before the object is lifted (s).
const CLOSING: f64 = 0.3;
/// Time constant of the mean load while the object is carried (s).
const MEAN: f64 = 0.2;

/// Mean load on a finger over time.
#[derive(Debug, Clone, Copy)]
pub(super) struct CarriedLoad {
    /// Minimum change of the shear that counts as a load (N).
    threshold: f64,
    /// Present mean shear of the fingers, low-pass filtered (N, in W).
    present: DVec3,
    /// Mean shear that remains from closing, before the object is lifted (N, in W).
    closing: DVec3,
    /// Smallest shear while it settles (N, in W), and the grip at that time (N).
    smallest: (DVec3, f64),
    /// Mean load while the object is carried (N, in W).
    mean: DVec3,
    /// Time at which the object was first loaded (s); `None` before.
    since: Option<f64>,
    /// Time of the first update (s); `None` before.
    start: Option<f64>,
}

impl CarriedLoad {
    /// Creates the estimate without a load. A change of a finger's mean shear by more than `threshold` (N) counts as a
    /// load.
    pub fn new(threshold: f64) -> Self {
        Self {
            threshold,
            present: DVec3::ZERO,
            closing: DVec3::ZERO,
            smallest: (DVec3::ZERO, 0.0),
            mean: DVec3::ZERO,
            since: None,
            start: None,
        }
    }

    /// Updates the estimate with the mean `shear` (N, in W) and the `grip` force (N) of the fingers at time `stamp` (s),
    /// `interval` (s) after the previous one.
    pub fn update(&mut self, shear: DVec3, grip: f64, stamp: f64, interval: f64) {
        let Some(start) = self.start else {
            (self.start, self.present) = (Some(stamp), shear);
            self.smallest = (shear, grip);
            return;
        };
        self.present += part(interval, PRESENT) * (shear - self.present);
        if self.since.is_some() {
            if !self.is_below(0.5) {
                self.mean += part(interval, MEAN) * (self.present - self.mean);
            }
            return;
        }
        let (before, change) = if stamp - start < SETTLING {
            self.closing = shear;
            // The finger that touched first pushes the object until the other presses equally. So only an increase of
            // the shear counts as a load, and only if it exceeds that of the grip.
            if self.present.length() < self.smallest.0.length() {
                self.smallest = (self.present, grip);
            }
            let (smallest, then) = self.smallest;
            let increase = (grip / then).max(1.0);
            (
                smallest,
                self.present.length() - smallest.length() * increase,
            )
        } else {
            self.closing += part(interval, CLOSING) * (shear - self.closing);
            (self.closing, self.present.distance(self.closing))
        };
        if change > self.threshold {
            self.since = Some(stamp);
            // The shear from closing may point anywhere.
            self.mean = self.present - before;
        }
    }

    /// Returns `true` once a load has been detected.
    pub fn is_carried(&self) -> bool {
        self.since.is_some()
    }

    /// Returns `true` if the object has been carried for longer than `duration` (s) at time `stamp` (s).
    pub fn is_for(&self, duration: f64, stamp: f64) -> bool {
        self.since.is_some_and(|since| stamp - since > duration)
    }

    /// Returns `true` if the object was carried and the present load is below the fraction `share` of its mean.
    pub fn is_below(&self, share: f64) -> bool {
        self.since.is_some() && self.present.dot(self.mean) < share * self.mean.length_squared()
    }

    /// Returns `true` if the object was carried and the load has reversed its direction, because something supports the
    /// object from below.
    pub fn is_supported(&self) -> bool {
        self.is_below(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Applies a constant `shear` along -z for `steps` of 10 ms from `start` (s).
    fn apply(load: &mut CarriedLoad, shear: f64, start: f64, steps: u32) -> f64 {
        for step in 0..steps {
            load.update(-shear * DVec3::Z, 1.0, start + 0.01 * f64::from(step), 0.01);
        }
        start + 0.01 * f64::from(steps)
    }

    #[test]
    fn a_load_is_carried_until_it_vanishes_or_reverses() {
        let mut load = CarriedLoad::new(0.06);
        // Shear from closing does not count.
        let lifted = apply(&mut load, -0.1, 0.0, 100);
        assert!(!load.is_below(1.0) && !load.is_for(0.0, lifted));
        let held = apply(&mut load, 0.5, lifted, 100);
        assert!(load.is_for(0.5, held) && !load.is_below(0.9));
        let unloaded = apply(&mut load, 0.02, held, 20);
        assert!(load.is_below(0.1) && !load.is_supported());
        apply(&mut load, -0.2, unloaded, 20);
        assert!(load.is_supported());
    }

    #[test]
    fn an_object_lifted_at_once_is_carried_and_decreasing_shear_is_no_load() {
        let mut settling = CarriedLoad::new(0.06);
        for step in 0..20 {
            let shear = 0.8 - 0.03 * f64::from(step);
            apply(&mut settling, shear, 0.01 * f64::from(step), 1);
        }
        assert!(!settling.is_carried());
        let mut lifted = CarriedLoad::new(0.06);
        for step in 0..20 {
            let shear = 0.1 + 0.03 * f64::from(step);
            apply(&mut lifted, shear, 0.01 * f64::from(step), 1);
        }
        assert!(lifted.is_carried());
    }

    #[test]
    fn shear_that_increases_with_the_grip_is_no_load() {
        let mut pressed = CarriedLoad::new(0.06);
        for step in 0..20 {
            let grip = 1.0 + f64::from(step);
            let stamp = 0.01 * f64::from(step);
            pressed.update(0.1 * grip * DVec3::Y, grip, stamp, 0.01);
        }
        assert!(!pressed.is_carried());
    }
}
