//! Law for a hand, composed of independent laws for its fingers.

use super::{HandLaw, Law};
use crate::control::plan::Plan;
use crate::control::sense::HandReadings;
use glam::DVec3;

/// Law for a hand that moves each finger with a separate [`Law`], without data from the other fingers.
#[derive(Debug, Clone)]
pub struct FingerLaws {
    laws: Vec<Box<dyn Law>>,
}

impl FingerLaws {
    /// Creates the law from one law per finger, in the order of the fingers.
    pub fn new(laws: Vec<Box<dyn Law>>) -> Self {
        Self { laws }
    }
}

impl HandLaw for FingerLaws {
    fn velocities(&mut self, plans: &[Plan], hand: &HandReadings<'_>, velocities: &mut [DVec3]) {
        let fingers = self.laws.iter_mut().zip(plans).zip(hand.fingers());
        for (((law, plan), finger), velocity) in fingers.zip(velocities) {
            *velocity = law.velocity(plan, &finger);
        }
    }
}
