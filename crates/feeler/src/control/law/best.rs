//! Control law that increases the grip before slip. Not in the paper.
//!
//! Tri-axial forces show the used fraction of the available friction, `|f_t| / (mu f_n)`, long before an element slips.
//! This law estimates the friction coefficient `mu` during contact and keeps the grasp force in proportion to the
//! shear, so that it rises before a slip instead of after it. It presses or yields such that no element exceeds its
//! maximum force. It uses neither SLIP nor OVER.

use super::{FRICTION, Law};
use crate::check::Checker;
use crate::control::flags::FlagThresholds;
use crate::control::plan::Plan;
use crate::control::sense::FingerReadings;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Parameters of the law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BestConfig {
    /// Initial estimate of the friction coefficient.
    pub friction: f64,
    /// Weight of one element's observation in one frame when the friction estimate is updated.
    pub learning_rate: f64,
    /// Ratio of the grasp force to the force required for the measured shear at the estimated friction.
    pub margin: f64,
    /// Minimum grasp force during a grasp (N).
    pub least_grasp_force: f64,
    /// Maximum force on an element (N). Limited to F2 (`control.over_force`) when the law is created, so that one
    /// value works for hands with differently rated elements.
    pub element_force: f64,
    /// Maximum compression requested of a slipping element, as a fraction of its total force before the slip. On an
    /// inclined element, shear also supports the surface.
    pub slip_share: f64,
    /// Pressing speed per missing force of an element (m/(N·s)).
    pub gain: f64,
    /// Maximum speed of pressing or yielding (m/s).
    pub pressing_speed: f64,
}

impl Default for BestConfig {
    /// Values for the reference experiment, chosen on 60 trials of `feeler compare cap-closing --seed 3`. The margin
    /// is large because the shear of a seated cap keeps growing while the grip follows. With this element force, the
    /// most loaded element bears no more than under the paper's law. The gain is half of 0.31 m/(N·s), the onset of
    /// oscillation for rubber of 205 N/m and a delay of 25 ms from force to motion (`gain k T = π/2`).
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
    /// Checks that every value of the table `key` is in its range. `thresholds` defines when an element is in contact.
    /// An element force above F2 is valid; see [`Self::limited_to`].
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

    /// Returns the configuration with the element force limited to `over_force` (F2, N).
    #[must_use]
    pub fn limited_to(mut self, over_force: f64) -> Self {
        self.element_force = self.element_force.min(over_force);
        self
    }
}

/// Compression below which an element's force is treated as noise (N).
const NOISE: f64 = 0.02;
/// Compression below which an element is not used to estimate friction (N).
const TELLING_FORCE: f64 = 0.15;
/// Drop of the shear force between two frames that indicates a slip (N).
const SLIP_DROP: f64 = 0.04;
/// Plausible range of friction coefficients.
const BELIEVABLE: (f64, f64) = (0.15, 1.5);

/// Force of one element along the pressing direction and across it (N).
#[derive(Debug, Clone, Copy, Default)]
struct Load {
    normal: f64,
    shear: f64,
}

/// Sum of the loads on a finger's elements that are in contact.
#[derive(Debug, Clone, Copy, Default)]
struct ContactLoad {
    /// Direction that presses the finger into the object, a unit vector in W.
    inward: DVec3,
    /// Sum of normal forces (N).
    normal: f64,
    /// Sum of the magnitudes of shear (N).
    shear: f64,
    /// Largest compression of an element (N): the present one, or the one expected after a slip.
    largest: f64,
    /// Number of elements with a normal force that is sufficient to estimate friction.
    touching: f64,
}

/// State of the law for one finger, with its friction estimate.
#[derive(Debug, Clone)]
pub struct Best {
    config: BestConfig,
    /// Estimated friction coefficient.
    friction: f64,
    /// Load on each element at the latest frame.
    loads: Vec<Load>,
    /// Sequence number of the latest frame.
    newest: Option<u64>,
}

impl Best {
    /// Creates the law for a finger of `elements` elements.
    pub fn new(config: BestConfig, elements: usize) -> Self {
        Self {
            friction: config.friction,
            config,
            loads: vec![Load::default(); elements],
            newest: None,
        }
    }

    /// Estimated friction coefficient.
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// Updates the friction estimate with the latest forces. Returns the finger's load.
    fn feel(&mut self, finger: &FingerReadings<'_>, towards_object: DVec3) -> ContactLoad {
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
                self.friction = learned(self.friction, rate, *last, load);
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

    /// Pressing speed (m/s); negative if the finger yields.
    fn pressing(&self, grip: &ContactLoad) -> f64 {
        let config = &self.config;
        let needed = config.margin * grip.shear / self.friction;
        let missing = needed.max(config.least_grasp_force) - grip.normal;
        // The touching elements share the force.
        let each = missing / grip.touching.max(1.0);
        let room = config.element_force - grip.largest;
        let speed = config.gain * each.min(room);
        speed.clamp(-config.pressing_speed, config.pressing_speed)
    }
}

impl Law for Best {
    fn velocity(&mut self, plan: &Plan, finger: &FingerReadings<'_>) -> DVec3 {
        let grip = self.feel(finger, plan.towards_object);
        match plan.keep_grasp {
            true => plan.velocity + self.pressing(&grip) * grip.inward,
            false => plan.velocity,
        }
    }
}

impl Load {
    /// Splits the `force` on a feeler (N, in W) into normal and shear components. `inward` points into the object.
    fn new(force: DVec3, inward: DVec3) -> Self {
        let normal = -force.dot(inward);
        Self {
            normal: normal.max(0.0),
            shear: (force + normal * inward).length(),
        }
    }
}

/// Direction into the object: mean of the outward dome normals of the elements in contact, weighted by force. `None`
/// without contact.
fn inward(finger: &FingerReadings<'_>) -> Option<DVec3> {
    let forces = finger.touch.frame.forces.iter().enumerate();
    let weighted = forces.filter(|(_, force)| force.z > NOISE);
    let sum: DVec3 = weighted
        .filter_map(|(element, force)| Some(force.z * finger.normal(element)?))
        .sum();
    sum.try_normalize()
}

/// Returns the friction estimate after the load of one element has changed from `last` to `now`. A slip gives the
/// coefficient itself; a sticking element gives a lower bound.
fn learned(friction: f64, rate: f64, last: Load, now: Load) -> f64 {
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
