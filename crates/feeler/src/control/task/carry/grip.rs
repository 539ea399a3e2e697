//! How hard to grip: as hard as what is held pulls, by the friction that the last slip showed.

/// What part of the load is forgotten with each control step: while what is held slips, shear is what friction leaves of
/// the load, not the load.
const FORGETTING: f64 = 0.01;
/// Least friction that is believed.
const LEAST_FRICTION: f64 = 0.05;

/// How hard each finger is to press.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grip {
    /// Coefficient of friction that is believed.
    friction: f64,
    /// Pressing force over what would just hold.
    margin: f64,
    /// Least and greatest pressing force of a finger, N.
    least: f64,
    most: f64,
    /// What each finger carries, N, and the shear that it felt last, N.
    load: f64,
    shear: f64,
}

impl Grip {
    /// A grip of at least `least` and at most `most` newtons a finger, `margin` times what would just hold at `friction`.
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

    /// Coefficient of friction that is believed.
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// Takes in what a finger feels on average: the force across it and the force that it presses with, N, and whether the
    /// shear of an element changes as where it slips.
    ///
    /// A slip is where it changes so while the whole shear falls: what loads a grip raises it. What is left then is the friction.
    pub fn feel(&mut self, shear: f64, pressing: f64, changes: bool) {
        if changes && shear < self.shear && pressing > 0.0 {
            self.friction = self.friction.min(shear / pressing).max(LEAST_FRICTION);
        }
        self.shear = shear;
        self.load = shear.max((1.0 - FORGETTING) * self.load);
    }

    /// How hard a finger is to press, N.
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
        // Loaded quickly: it changes, and rises.
        for shear in [0.1, 0.3, 0.5] {
            grip.feel(shear, 1.5, true);
        }
        assert_eq!((grip.friction(), grip.pressing()), (0.5, 1.5));
        // It becomes slippery: at 1.5 N, 0.3 N are left of 0.5 N.
        grip.feel(0.3, 1.5, true);
        assert!((grip.friction() - 0.2).abs() < 1e-12);
        // The load is known from before, but for one step's forgetting.
        let needed = 1.5 * 0.5 / 0.2;
        assert!((grip.pressing() / needed - 1.0).abs() < 0.011);
    }

    #[test]
    fn it_grips_no_harder_than_it_may() {
        let mut grip = grip();
        grip.feel(0.5, 1.5, false);
        grip.feel(0.0, 1.5, true);
        assert_eq!(grip.friction(), LEAST_FRICTION);
        assert_eq!(grip.pressing(), 4.0);
    }
}
