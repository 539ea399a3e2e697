//! Beyond the paper: grip before slip.
//!
//! Tri-axial forces tell how much of the friction is used, `|f_t| / f_n`, long before anything slips. This
//! law learns the friction coefficient from the touch itself, keeps the grasp force in proportion to the
//! shear, so that it rises before a slip and not after, and presses or gives way so that no element
//! exceeds its force. It needs neither SLIP nor OVER.

use super::{FRICTION, Law};
use crate::check::Checker;
use crate::control::flags::FlagThresholds;
use crate::control::plan::Plan;
use crate::control::sense::FingerSense;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// What the law is tuned by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BestConfig {
    /// Coefficient of friction that is believed before anything was felt.
    pub friction: f64,
    /// Part of the way that the learnt friction goes towards what one frame of one element shows.
    pub learning_rate: f64,
    /// Grasp force over what the learnt friction needs for the shear that is felt.
    pub margin: f64,
    /// Least grasp force while a grasp is kept, N.
    pub least_grasp_force: f64,
    /// Force that no element is to exceed, N. Limited to F2 (`control.over_force`) when the law is built, so that one
    /// value serves hands whose elements are rated differently.
    pub element_force: f64,
    /// An element that leans to the surface stands against it with its shear, too; when it slips, up to
    /// this part of its whole force becomes compression at a stroke.
    pub slip_share: f64,
    /// Speed of pressing per missing force of an element, m/(N·s).
    pub gain: f64,
    /// Greatest speed of pressing or giving way, m/s.
    pub pressing_speed: f64,
}

impl Default for BestConfig {
    /// For the reference experiment, chosen on 60 trials of `feeler compare cap-closing --seed 3`. The margin
    /// is that large because the shear of a seated cap grows on while the grip follows. The element's force is
    /// such that the hardest pressed element bears no more than under the paper's law. The gain is half of
    /// 0.31 m/(N·s), where rubber of 205 N/m and a delay of 25 ms from force to motion begin to swing
    /// (`gain k T = π/2`).
    fn default() -> Self {
        Self {
            friction: 0.6,
            learning_rate: 0.3,
            margin: 3.0,
            least_grasp_force: 0.8,
            element_force: 0.47,
            slip_share: 0.6,
            gain: 0.16,
            pressing_speed: 0.008,
        }
    }
}

impl BestConfig {
    /// Requires every value of the table `key` to be in its range; elements touch as the `thresholds` say. An element force
    /// above F2 is valid, see [`Self::limited_to`].
    pub fn check(&self, key: &str, thresholds: &FlagThresholds, checker: &mut Checker) {
        let key = |field: &str| format!("{key}.{field}");
        checker.between(&key("friction"), self.friction, FRICTION.0, FRICTION.1);
        checker.between(&key("learning_rate"), self.learning_rate, 0.0, 1.0);
        checker.between(&key("margin"), self.margin, 1.0, 100.0);
        checker.not_negative(&key("least_grasp_force"), self.least_grasp_force);
        let touch = thresholds.touch_force;
        checker.require(
            &key("element_force"),
            self.element_force.to_string(),
            self.element_force > touch && self.element_force.is_finite(),
            &format!("finite and more than control.touch_force (F1) = {touch}"),
        );
        checker.between(&key("slip_share"), self.slip_share, 0.0, 1.0);
        checker.not_negative(&key("gain"), self.gain);
        checker.not_negative(&key("pressing_speed"), self.pressing_speed);
    }

    /// Returns the configuration with an element force of at most `over_force` (F2), N.
    #[must_use]
    pub fn limited_to(mut self, over_force: f64) -> Self {
        self.element_force = self.element_force.min(over_force);
        self
    }
}

/// An element that is pressed less than this may be noise, N.
const NOISE: f64 = 0.02;
/// An element that is pressed less than this says nothing about friction, N.
const TELLING_FORCE: f64 = 0.15;
/// An element whose shear force falls by this much from one frame to the next has slipped, N.
const SLIP_DROP: f64 = 0.04;
/// Range of coefficients that are believed.
const BELIEVABLE: (f64, f64) = (0.15, 1.5);

/// Force of one element along the finger's direction into the object and across it, N.
#[derive(Debug, Clone, Copy, Default)]
struct Load {
    normal: f64,
    shear: f64,
}

/// What a finger's touching elements bear together.
#[derive(Debug, Clone, Copy, Default)]
struct ContactLoad {
    /// Direction that presses the finger into the object, a unit vector in W.
    inward: DVec3,
    /// Sum of normal forces, N.
    normal: f64,
    /// Sum of the magnitudes of shear, N.
    shear: f64,
    /// Largest compression of an element, or what a slip may make of it, N.
    largest: f64,
    /// Number of elements that bear more than a little.
    touching: f64,
}

/// One finger that learns the friction of what it touches.
#[derive(Debug, Clone)]
pub struct Best {
    config: BestConfig,
    /// Learnt coefficient of friction.
    friction: f64,
    /// What each element bore at the newest frame.
    loads: Vec<Load>,
    /// Sequence number of that frame.
    newest: Option<u64>,
}

impl Best {
    /// A finger of `elements` elements that has learnt nothing yet.
    pub fn new(config: BestConfig, elements: usize) -> Self {
        Self {
            friction: config.friction,
            config,
            loads: vec![Load::default(); elements],
            newest: None,
        }
    }

    /// The learnt coefficient of friction.
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// Takes in the newest forces: what the finger bears, and what that teaches about friction.
    fn feel(&mut self, finger: &FingerSense<'_>, towards_object: DVec3) -> ContactLoad {
        let frame = &finger.touch.frame;
        let new = self.newest.replace(frame.sequence) != Some(frame.sequence);
        let inward = inward(finger).unwrap_or(towards_object);
        let mut grip = ContactLoad {
            inward,
            ..ContactLoad::default()
        };
        for (element, (last, local)) in self.loads.iter_mut().zip(&frame.forces).enumerate() {
            let pressed = local.z > NOISE;
            let load = match pressed {
                true => Load::new(finger.force(element), inward),
                false => Load::default(),
            };
            if new {
                let rate = self.config.learning_rate;
                self.friction = learnt(self.friction, rate, *last, load);
                *last = load;
            }
            grip.normal += load.normal;
            grip.shear += load.shear;
            grip.touching += f64::from(u8::from(load.normal > TELLING_FORCE));
            if pressed {
                let slipped = self.config.slip_share * local.length();
                grip.largest = grip.largest.max(local.z).max(slipped);
            }
        }
        grip
    }

    /// Speed at which the finger presses on, or gives way where it is negative, m/s.
    fn pressing(&self, grip: &ContactLoad) -> f64 {
        let config = &self.config;
        let needed = config.margin * grip.shear / self.friction;
        let missing = needed.max(config.least_grasp_force) - grip.normal;
        // All that touch share in a press.
        let each = missing / grip.touching.max(1.0);
        let room = config.element_force - grip.largest;
        let speed = config.gain * each.min(room);
        speed.clamp(-config.pressing_speed, config.pressing_speed)
    }
}

impl Law for Best {
    fn velocity(&mut self, plan: &Plan, finger: &FingerSense<'_>) -> DVec3 {
        let grip = self.feel(finger, plan.towards_object);
        match plan.keep_grasp {
            true => plan.velocity + self.pressing(&grip) * grip.inward,
            false => plan.velocity,
        }
    }
}

impl Load {
    /// Of the `force` on a feeler (N, in W) where `inward` points into the object.
    fn new(force: DVec3, inward: DVec3) -> Self {
        let normal = -force.dot(inward);
        Self {
            normal: normal.max(0.0),
            shear: (force + normal * inward).length(),
        }
    }
}

/// The dome's outward normal where it touches: the mean of the elements', weighted by their force.
fn inward(finger: &FingerSense<'_>) -> Option<DVec3> {
    let forces = finger.touch.frame.forces.iter().enumerate();
    let weighted = forces.filter(|(_, force)| force.z > NOISE);
    let sum: DVec3 = weighted
        .filter_map(|(element, force)| Some(force.z * finger.normal(element)?))
        .sum();
    sum.try_normalize()
}

/// What is believed about friction after one element's load went from `last` to `now`: a slip shows the
/// coefficient, and what holds shows that it is no less.
fn learnt(friction: f64, rate: f64, last: Load, now: Load) -> f64 {
    if last.normal < TELLING_FORCE || now.normal < TELLING_FORCE {
        return friction;
    }
    let held = last.shear / last.normal;
    let slipped = last.shear - now.shear > SLIP_DROP && now.normal > 0.9 * last.normal;
    if !slipped && held <= friction {
        return friction;
    }
    (friction + rate * (held - friction)).clamp(BELIEVABLE.0, BELIEVABLE.1)
}
