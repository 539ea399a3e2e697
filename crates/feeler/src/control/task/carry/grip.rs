//! Computes the grip force from the load of the object and the friction estimated at the last slip.

/// Relative decay of the estimated load per control step. The estimate decays slowly because the shear of a slipping
/// object is limited by friction and does not indicate the load.
const FORGETTING: f64 = 0.01;
/// Lower bound of the friction estimate.
const MIN_FRICTION: f64 = 0.05;

/// Grip controller: computes the pressing force of each finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grip {
    /// Estimated friction coefficient.
    friction: f64,
    /// Ratio of the pressing force to the minimum that holds the object.
    margin: f64,
    /// Minimum pressing force of a finger (N).
    least: f64,
    /// Maximum pressing force of a finger (N).
    most: f64,
    /// Estimated load on each finger (N).
    load: f64,
    /// Latest mean shear of a finger (N).
    shear: f64,
}

impl Grip {
    /// Creates a controller with a pressing force of `least` to `most` (N) per finger, `margin` times the minimum that
    /// holds the object at the friction coefficient `friction`.
    pub fn new(friction: f64, margin: f64, least: f64, most: f64) -> Self {
        Self {
            friction,
            margin,
            least,
            most,
            load: 0.0,
            shear: 0.0,
        }
    }

    /// Estimated friction coefficient.
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// Updates load and friction with the mean shear and pressing force of a finger (N). `changes` is `true` if the
    /// shear rate of an element indicates a slip.
    ///
    /// A slip is detected if `changes` is set while the total shear falls, because loading raises the shear. The
    /// friction is then estimated from the remaining shear.
    pub fn feel(&mut self, shear: f64, pressing: f64, changes: bool) {
        if changes && shear < self.shear && pressing > 0.0 {
            self.friction = self.friction.min(shear / pressing).max(MIN_FRICTION);
        }
        self.shear = shear;
        self.load = shear.max((1.0 - FORGETTING) * self.load);
    }

    /// Requested pressing force of a finger (N).
    pub fn pressing(&self) -> f64 {
        (self.margin * self.load / self.friction).clamp(self.least, self.most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grip() -> Grip {
        Grip::new(0.5, 1.5, 1.0, 4.0)
    }

    #[test]
    fn grip_is_in_proportion_to_shear_within_its_bounds() {
        for (shear, pressing) in [(0.5, 1.5), (0.0, 1.0), (9.0, 4.0)] {
            let mut grip = grip();
            grip.feel(shear, 2.0, false);
            assert_eq!(grip.pressing(), pressing);
        }
    }

    #[test]
    fn a_slip_shows_the_friction_and_load_alone_does_not() {
        let mut grip = grip();
        // A quick load changes the shear, but raises it.
        for shear in [0.1, 0.3, 0.5] {
            grip.feel(shear, 1.5, true);
        }
        assert_eq!((grip.friction(), grip.pressing()), (0.5, 1.5));
        // The object becomes slippery: at 1.5 N, 0.3 N of 0.5 N remain.
        grip.feel(0.3, 1.5, true);
        assert!((grip.friction() - 0.2).abs() < 1e-12);
        // The load is known from before, except for one step of forgetting.
        let needed = 1.5 * 0.5 / 0.2;
        assert!((grip.pressing() / needed - 1.0).abs() < 0.011);
    }

    #[test]
    fn it_grips_no_harder_than_it_may() {
        let mut grip = grip();
        grip.feel(0.5, 1.5, false);
        grip.feel(0.0, 1.5, true);
        assert_eq!(grip.friction(), MIN_FRICTION);
        assert_eq!(grip.pressing(), 4.0);
    }
}
