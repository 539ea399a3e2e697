//! Control of the grasp force to slightly more than the minimum that prevents slip.
//!
//! The minimum grasp force is the load on the finger divided by the friction coefficient (`friction.rs`). The finger
//! reacts to a slip within the same control period: a velocity pulse presses the feelers deeper by a fixed fraction,
//! independently of the speed of the drives, and the target grasp force is increased for a while.

use super::friction::{Friction, Observation};
use crate::control::feeler_shape::{FeelerShape, Stiffness};
use crate::control::sense::FingerReadings;
use crate::control::slip_detector::SlipDetector;
use glam::{DVec2, DVec3};

/// Additional grasp force after a slip, relative to the minimum.
const EXTRA: f64 = 0.15;
/// Time constant of the decay of the additional grasp force (s).
const EXTRA_TIME: f64 = 0.1;
/// Depth of the velocity pulse after a slip, relative to the current deformation of the feelers.
const PULSE: f64 = 0.45;
/// Minimum grasp force, relative to F1. Below F1, an element is not in contact and its slip cannot be detected.
const MIN_TOUCH: f64 = 1.5;
/// Rate of relative change of the grasp force per relative error (1/s).
const GAIN: f64 = 10.0;
/// Maximum relative error to which the gain is applied.
const LARGEST_ERROR: f64 = 0.5;
/// Maximum speed towards the object (m/s).
const INWARD_SPEED: f64 = 0.05;
/// Maximum speed away from the object (m/s).
const OUTWARD_SPEED: f64 = 0.004;
/// Lead time for extrapolating the load (s): about one control period plus the drive lag.
const LOAD_LEAD: f64 = 0.03;
/// Lead time for extrapolating the grasp force (s).
const GRIP_LEAD: f64 = 0.015;
/// Weight of the latest rate of change in its low-pass filter.
const RATE_FILTER: f64 = 0.4;
/// Weight of the latest frame in the estimated variance of the noise.
const NOISE_FILTER: f64 = 0.02;
/// Compression below which an element counts as not in contact (N).
const UNTOUCHED: f64 = 0.03;

/// Force (N) and its low-pass filtered rate of change (N/s).
#[derive(Debug, Clone, Copy, Default)]
struct Tracked {
    force: f64,
    rate: f64,
}

impl Tracked {
    fn update(&mut self, force: f64, interval: f64) {
        if interval > 0.0 {
            let rate = (force - self.force) / interval;
            self.rate += RATE_FILTER * (rate - self.rate);
        }
        self.force = force;
    }

    fn after(self, time: f64) -> f64 {
        self.force + time * self.rate
    }
}

/// Object's surface at the contact of a finger that turns the object.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    /// Contact stiffness of the feelers.
    pub stiffness: Stiffness,
    /// Position of the object's axis (m, x and y in W).
    pub pivot: DVec2,
}

impl Surface {
    /// Force on the feeler of `element` (N): along the surface normal (positive when pressed), along the surface
    /// tangent perpendicular to z of W, and along z of W. `None` if the element is not in contact.
    fn force(&self, sense: &FingerReadings<'_>, element: usize) -> Option<DVec3> {
        let own = sense.layout.elements.get(element)?;
        let force = *sense.touch.frame.forces.get(element)?;
        if force.z < UNTOUCHED || !force.is_finite() {
            return None;
        }
        let tip = sense.layout.tip(element) + own.rotation * self.stiffness.displacement(force);
        let tip = sense.pose.position + sense.pose.rotation * tip;
        let outward = (tip.truncate() - self.pivot).normalize_or_zero();
        let force = sense.force(element);
        let across = force.truncate();
        Some(DVec3::new(
            across.dot(outward),
            outward.perp_dot(across),
            force.z,
        ))
    }
}

/// Estimates the grasp force that one finger requires, from its load and from slip.
#[derive(Debug, Clone)]
pub(super) struct NeededGrip {
    detector: SlipDetector,
    friction: Friction,
    /// F1: compression above which an element is in contact (N).
    touch_force: f64,
    /// Sequence number of the latest frame.
    newest: Option<u64>,
    /// `true` if [`Self::feel`] has not processed that frame yet.
    is_new: bool,
    stamp: f64,
    /// Interval between the two latest frames (s).
    interval: f64,
    /// Variance of the noise of a shear component (N²).
    noise: f64,
    /// Sum over the elements in contact of the force along the surface normal.
    normal: Tracked,
    /// Sum over the elements in contact of the force along the surface tangent perpendicular to z of W.
    load: Tracked,
    /// Additional grasp force after the latest slip, relative to the minimum.
    extra: f64,
}

impl NeededGrip {
    /// Creates the estimator for a finger of `elements` elements, which are in contact above `touch_force` (F1, N).
    pub fn new(touch_force: f64, elements: usize) -> Self {
        let feeler = FeelerShape::default();
        Self {
            detector: SlipDetector::for_movable_object(feeler, touch_force, elements),
            friction: Friction::new(elements),
            touch_force,
            newest: None,
            is_new: false,
            stamp: 0.0,
            interval: 0.0,
            noise: 0.0,
            normal: Tracked::default(),
            load: Tracked::default(),
            extra: 0.0,
        }
    }

    /// Sets the contact stiffness of the feelers.
    pub fn set_stiffness(&mut self, stiffness: Stiffness) {
        self.detector.set_stiffness(stiffness);
    }

    /// Predicts the shear forces of a new frame. Returns the fraction (0 to 1) of the fingertip's motion that the
    /// object may have followed, estimated from this finger alone; 1 if the frame is not new.
    pub fn predict_shear(&mut self, sense: &FingerReadings<'_>) -> f64 {
        let sequence = Some(sense.touch.frame.sequence);
        self.is_new = std::mem::replace(&mut self.newest, sequence) != sequence;
        if !self.is_new {
            return 1.0;
        }
        self.measure_noise(&sense.touch.frame.forces);
        self.detector.predict_shear(sense)
    }

    /// Updates the estimates of slip, friction and load with a new frame of a finger. `turns` is `true` while the finger turns
    /// the object; `along` is the fraction of the fingertip's motion that the object has followed, 0 to 1.
    pub fn feel(&mut self, sense: &FingerReadings<'_>, surface: Surface, turns: bool, along: f64) {
        if !std::mem::take(&mut self.is_new) {
            return;
        }
        let frame = &sense.touch.frame;
        self.interval = frame.stamp - std::mem::replace(&mut self.stamp, frame.stamp);
        self.extra *= libm::exp(-self.interval / EXTRA_TIME);
        if turns {
            self.friction.start(self.interval);
        } else {
            self.friction.rest();
        }
        let noise = self.noise.sqrt();
        let lost = self.detector.detect_on(sense, along);
        let (mut normal, mut load) = (0.0, 0.0);
        for (index, (force, &lost)) in frame.forces.iter().zip(lost).enumerate() {
            let contact = surface.force(sense, index).unwrap_or_default();
            normal += contact.x;
            load += contact.y;
            let touches = turns && force.z > self.touch_force && contact.x > 0.0;
            let now = touches.then(|| Observation {
                ratio: libm::hypot(contact.y, contact.z) / contact.x,
                normal: force.z,
                lost,
                noise,
            });
            self.friction.add(index, now);
        }
        self.normal.update(normal, self.interval);
        self.load.update(load, self.interval);
        if self.friction.slips() {
            self.extra = EXTRA;
        }
    }

    /// Updates the variance of the noise from the elements that are not in contact.
    fn measure_noise(&mut self, forces: &[DVec3]) {
        let untouched = forces.iter().filter(|force| force.z < UNTOUCHED);
        let squares = untouched.map(|force| 0.5 * force.truncate().length_squared());
        let (count, sum) = squares.fold((0.0, 0.0), |(count, sum), square| {
            (count + 1.0, sum + square)
        });
        if count > 0.0 && sum.is_finite() {
            self.noise += NOISE_FILTER * (sum / count - self.noise);
        }
    }

    /// Radial speed away from the pivot (m/s) of a finger whose most pressed feeler is deformed by `depth` (m).
    pub fn speed(&self, depth: f64) -> f64 {
        let pulse = if self.friction.slips() && self.interval > 0.0 {
            PULSE / self.interval
        } else {
            0.0
        };
        let change = self.missing_grip().clamp(-LARGEST_ERROR, LARGEST_ERROR);
        let inward = (GAIN * change + pulse) * depth;
        -inward.clamp(-OUTWARD_SPEED, INWARD_SPEED)
    }

    /// Missing grasp force relative to the current one; 0 if the friction is unknown or no element is in contact.
    fn missing_grip(&self) -> f64 {
        let (Some(friction), true) = (self.friction.coefficient(), self.normal.force > 0.0) else {
            return 0.0;
        };
        let needed = (1.0 + self.extra) * self.load.after(LOAD_LEAD).abs() / friction;
        let least = MIN_TOUCH * self.touch_force;
        let normal = self.normal.after(GRIP_LEAD).max(0.5 * self.normal.force);
        needed.max(least) / normal - 1.0
    }
}

#[cfg(test)]
mod tests;
