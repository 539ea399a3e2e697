//! How far what is held has moved, from touch: feelers that stick go with it.

use super::super::surface::touching;
use crate::control::feeler_shape::FeelerShape;
use crate::control::sense::HandSense;
use crate::sensor::fingertip::MAX_ELEMENTS;
use glam::DVec3;

/// Most fingers that are followed.
pub const MAX_FINGERS: usize = 5;

/// Adds up the motion of the tips that stick.
#[derive(Debug, Clone)]
pub struct Odometry {
    /// Where each tip was a step ago, m, in W, if it touched.
    tips: Box<[[Option<DVec3>; MAX_ELEMENTS]; MAX_FINGERS]>,
    /// How far the object has moved, m, in W.
    pub moved: DVec3,
    /// How far it has turned about W's z, rad.
    pub turned: f64,
}

/// A tip that has stuck since the last step.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// Where it is, m, in W.
    tip: DVec3,
    /// How far it has moved, m.
    moved: DVec3,
    /// How much it is believed: the force on it, N.
    weight: f64,
}

impl Odometry {
    /// Nothing has moved yet.
    pub fn new() -> Self {
        Self {
            tips: Box::new([[None; MAX_ELEMENTS]; MAX_FINGERS]),
            moved: DVec3::ZERO,
            turned: 0.0,
        }
    }

    /// Begins anew from here.
    pub fn reset(&mut self) {
        (self.moved, self.turned) = (DVec3::ZERO, 0.0);
    }

    /// Takes in what `hand` feels. Elements on which a larger force than `touch_force` (N) is touch; of those, the ones
    /// whose shear force changes no faster than `slip_threshold` (N/s) stick.
    pub fn follow(
        &mut self,
        hand: &HandSense<'_>,
        feeler: &FeelerShape,
        touch_force: f64,
        slip_threshold: f64,
    ) {
        let (mut weight, mut moved, mut middle) = (0.0, DVec3::ZERO, DVec3::ZERO);
        let steps = || steps(&self.tips, hand, feeler, touch_force, slip_threshold);
        for step in steps() {
            weight += step.weight;
            moved += step.weight * step.moved;
            middle += step.weight * step.tip;
        }
        if weight > 0.0 {
            (moved, middle) = (moved / weight, middle / weight);
            let (mut turning, mut inertia) = (0.0, 0.0);
            for step in steps() {
                let lever = (step.tip - middle).truncate();
                turning += step.weight * lever.perp_dot((step.moved - moved).truncate());
                inertia += step.weight * lever.length_squared();
            }
            self.moved += moved;
            if inertia > 0.0 {
                self.turned += turning / inertia;
            }
        }
        self.remember(hand, feeler, touch_force);
    }

    fn remember(&mut self, hand: &HandSense<'_>, feeler: &FeelerShape, touch_force: f64) {
        for (tips, finger) in self.tips.iter_mut().zip(hand.fingers()) {
            let elements = finger.layout.elements.len().min(MAX_ELEMENTS);
            tips[..elements].fill(None);
            for (element, _) in touching(&finger, touch_force) {
                if let Some(tip) = tips.get_mut(element) {
                    *tip = feeler.tip(&finger, element);
                }
            }
        }
    }
}

/// The tips that stuck since the last step.
fn steps<'a>(
    tips: &'a [[Option<DVec3>; MAX_ELEMENTS]; MAX_FINGERS],
    hand: &'a HandSense<'_>,
    feeler: &'a FeelerShape,
    touch_force: f64,
    slip_threshold: f64,
) -> impl Iterator<Item = Step> + 'a {
    let fingers = tips.iter().zip(hand.fingers());
    fingers.flat_map(move |(tips, finger)| {
        tips.iter()
            .enumerate()
            .take(finger.layout.elements.len())
            .filter_map(move |(element, &before)| {
                let before = before?;
                let weight = finger.force(element).length();
                let slips = finger.touch.shear_rate.get(element)? > &slip_threshold;
                let tip = feeler.tip(&finger, element)?;
                (weight > touch_force && !slips).then_some(Step {
                    tip,
                    moved: tip - before,
                    weight,
                })
            })
    })
}
