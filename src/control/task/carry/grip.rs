//! How hard to grip: as hard as what is held pulls, by the friction that is believed, which every slip lowers.

/// What part of the friction believed is given up with each control step in which something slips.
const DOUBT: f64 = 0.06;
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
}

impl Grip {
    /// A grip of at least `least` and at most `most` newtons a finger, `margin` times what would just hold at `friction`.
    pub fn new(friction: f64, margin: f64, least: f64, most: f64) -> Self {
        Self {
            friction,
            margin,
            least,
            most,
        }
    }

    /// Coefficient of friction that is believed.
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// Something slips: there is less friction than was believed.
    pub fn slipped(&mut self) {
        self.friction = (self.friction * (1.0 - DOUBT)).max(LEAST_FRICTION);
    }

    /// How hard a finger is to press where `shear` (N) acts across it, N.
    pub fn pressing(&self, shear: f64) -> f64 {
        (self.margin * shear / self.friction).clamp(self.least, self.most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grip_is_in_proportion_to_shear_within_its_bounds() {
        let grip = Grip::new(0.5, 1.5, 1.0, 4.0);
        assert_eq!(grip.pressing(0.5), 1.5);
        assert_eq!(grip.pressing(0.0), 1.0);
        assert_eq!(grip.pressing(9.0), 4.0);
    }

    #[test]
    fn slip_makes_it_firmer_but_never_endlessly() {
        let mut grip = Grip::new(0.5, 1.5, 1.0, 4.0);
        let before = grip.pressing(0.5);
        grip.slipped();
        assert!(grip.pressing(0.5) > before);
        for _ in 0..1000 {
            grip.slipped();
        }
        assert_eq!(grip.friction(), LEAST_FRICTION);
        assert_eq!(grip.pressing(0.5), 4.0);
    }
}
