//! Odometry of a held object: its motion is that of the feelers that stick to it.

use crate::control::feeler_shape::FeelerShape;
use crate::control::sense::HandReadings;
use crate::hand::MAX_FINGERS;
use crate::sensor::fingertip::layout::MAX_ELEMENTS;
use glam::DVec3;

/// Minimum mean squared distance of the tips from their centre (m²) for measuring a rotation.
const ALONE: f64 = 1e-12;

/// Estimates the motion of the held object by accumulating the motion of the tips that stick to it.
#[derive(Debug, Clone)]
pub struct Odometry {
    /// Position of each feeler tip in the previous step (m, in W); `None` if it was not in contact.
    tips: Box<[[Option<DVec3>; MAX_ELEMENTS]; MAX_FINGERS]>,
    /// Displacement of the object (m, in W).
    pub moved: DVec3,
    /// Rotation of the object about W's z (rad).
    pub turned: f64,
}

/// Sums over the tips that stuck during the last step, weighted by their forces.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    weight: f64,
    /// Sum of the tips' positions, weighted by force (N·m).
    tips: DVec3,
    /// Sum of the tips' displacements, weighted by force (N·m).
    moved: DVec3,
    /// Sum of lever arm times tangential motion about W's z axis, weighted by force (N·m²).
    turning: f64,
    /// Sum of squared lever arms about W's z axis, weighted by force (N·m²).
    inertia: f64,
}

impl Odometry {
    /// Creates the odometry of an object that has not moved.
    pub fn new() -> Self {
        Self {
            tips: Box::new([[None; MAX_ELEMENTS]; MAX_FINGERS]),
            moved: DVec3::ZERO,
            turned: 0.0,
        }
    }

    /// Resets the estimated motion of the object to zero.
    pub fn reset(&mut self) {
        (self.moved, self.turned) = (DVec3::ZERO, 0.0);
    }

    /// Updates the motion with the readings of `hand`. Elements with a force above `touch_force` (N) are in contact;
    /// those with a shear rate of at most `slip_threshold` (N/s) stick.
    pub fn follow(
        &mut self,
        hand: &HandReadings<'_>,
        feeler: &FeelerShape,
        touch_force: f64,
        slip_threshold: f64,
    ) {
        let mut sums = Sums::default();
        for (tips, finger) in self.tips.iter_mut().zip(hand.fingers()) {
            let felt = finger.touch.frame.forces.iter();
            let rates = &finger.touch.shear_rate;
            for (element, ((last, felt), rate)) in tips.iter_mut().zip(felt).zip(rates).enumerate()
            {
                let before = last.take();
                if felt.length_squared() <= touch_force * touch_force {
                    continue;
                }
                *last = feeler.tip(&finger, element, finger.force(element));
                if let (Some(before), Some(tip), true) = (before, *last, *rate <= slip_threshold) {
                    sums.add(felt.length(), tip, tip - before);
                }
            }
        }
        let (moved, turned) = sums.motion();
        self.moved += moved;
        self.turned += turned;
    }
}

impl Sums {
    fn add(&mut self, weight: f64, tip: DVec3, moved: DVec3) {
        let (lever, across) = (tip.truncate(), moved.truncate());
        self.weight += weight;
        self.tips += weight * tip;
        self.moved += weight * moved;
        self.turning += weight * lever.perp_dot(across);
        self.inertia += weight * lever.length_squared();
    }

    /// Mean displacement of the tips (m), and rotation about their centroid (rad).
    fn motion(&self) -> (DVec3, f64) {
        if self.weight <= 0.0 {
            return (DVec3::ZERO, 0.0);
        }
        let (middle, moved) = (self.tips / self.weight, self.moved / self.weight);
        // Parallel axis theorem: from W's origin to the centre.
        let turning = self.turning - self.weight * middle.truncate().perp_dot(moved.truncate());
        let inertia = self.inertia - self.weight * middle.truncate().length_squared();
        let turned = if inertia > ALONE * self.weight {
            turning / inertia
        } else {
            0.0
        };
        (moved, turned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_is_measured_about_any_axis() {
        let turn = 0.002;
        let axis = DVec3::new(0.01, -0.02, 0.1);
        let mut sums = Sums::default();
        for (weight, x, y) in [(1.0, 0.03, 0.0), (0.4, -0.03, 0.004), (2.0, -0.029, -0.003)] {
            let tip = DVec3::new(x, y, 0.1);
            let before = axis + glam::DMat3::from_rotation_z(-turn) * (tip - axis);
            sums.add(weight, tip, tip - before);
        }
        // First order in the rotation of a step.
        assert!((sums.motion().1 / turn - 1.0).abs() < turn);
    }

    #[test]
    fn a_single_tip_measures_no_rotation() {
        let mut sums = Sums::default();
        sums.add(0.7, DVec3::new(0.03, 0.01, 0.1), DVec3::X);
        let (moved, turned) = sums.motion();
        assert!((moved - DVec3::X).length() < 1e-12);
        assert_eq!(turned, 0.0);
    }
}
