//! Contact of one feeler: an anisotropic spring between its undeformed tip and an anchor on the
//! object's surface, held there by friction (design, section 8).

use super::object::Object;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A slipping anchor is followed along the surface in steps; on a cylinder two or three suffice.
const MAX_SLIP_ITERATIONS: usize = 16;
/// A slip ends when the shear force exceeds the kinetic limit by less than this fraction.
const SLIP_TOLERANCE: f64 = 1e-9;

/// The silicone-rubber feelers of a fingertip; all alike.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FeelerConfig {
    /// Stiffness along the feeler's axis, N/m.
    pub normal_stiffness: f64,
    /// Stiffness across the feeler's axis, N/m.
    pub shear_stiffness: f64,
    /// Radius of the feeler's rounded tip, m.
    pub tip_radius: f64,
    /// Friction coefficient of a tip that sticks to the object.
    pub static_friction: f64,
    /// Friction coefficient of a tip that slips over the object.
    pub kinetic_friction: f64,
}

/// Where a feeler holds on to the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// Centre of the deformed tip's sphere, m, in the object's frame.
    pub position: DVec3,
    /// Outward normal of the object's surface under it, in the object's frame.
    pub normal: DVec3,
}

/// The undeformed feeler relative to the object.
#[derive(Debug, Clone, Copy)]
pub struct Tip {
    /// Centre of the undeformed tip's sphere, m, in the object's frame.
    pub position: DVec3,
    /// The feeler's axis, outward from the dome, a unit vector in the object's frame.
    pub axis: DVec3,
}

impl FeelerConfig {
    /// Force on the object by a feeler whose tip is held at `anchor`, N, in the object's frame.
    pub fn elastic_force(&self, tip: &Tip, anchor: DVec3) -> DVec3 {
        self.stiffness_times(tip.axis, tip.position - anchor)
    }

    /// The stiffness matrix `K = k_t I + (k_n - k_t) n n^T` of a feeler along `axis`, times
    /// `displacement` (m); N.
    pub fn stiffness_times(&self, axis: DVec3, displacement: DVec3) -> DVec3 {
        self.shear_stiffness * displacement
            + (self.normal_stiffness - self.shear_stiffness) * axis.dot(displacement) * axis
    }

    /// The anchor that a free feeler takes when its tip has come to the surface, if it has.
    pub fn touch(&self, object: &Object, tip: &Tip) -> Option<Anchor> {
        if !object.is_near(tip.position, self.tip_radius) {
            return None;
        }
        let surface = object.nearest(tip.position)?;
        (surface.distance < self.tip_radius).then_some(Anchor {
            position: surface.position + self.tip_radius * surface.normal,
            normal: surface.normal,
        })
    }

    /// The force that an anchored feeler can pass on without slipping, N, in the object's frame:
    /// the elastic force, its shear cut at the static friction limit; zero where it would pull.
    pub fn holding_force(&self, tip: &Tip, anchor: &Anchor) -> DVec3 {
        let force = self.elastic_force(tip, anchor.position);
        let (normal_force, shear) = split(force, anchor.normal);
        if normal_force <= 0.0 {
            return DVec3::ZERO;
        }
        shear.clamp_length_max(self.static_friction * normal_force) - normal_force * anchor.normal
    }

    /// Lets an anchor slip if its shear force exceeds the static friction limit, and gives it up if
    /// it would pull: the anchor that remains and the force on the object by the feeler, N, in the
    /// object's frame.
    ///
    /// The feeler has no mass: a slip snaps within the step, the shear force falling to the kinetic
    /// limit, and there the tip sticks again. (The drive is slow against the snap, so the tip is
    /// at rest whenever it is not snapping; the shear force makes a sawtooth between both limits.)
    pub fn settle(&self, object: &Object, tip: &Tip, anchor: Anchor) -> Option<(Anchor, DVec3)> {
        self.slip(object, tip, anchor, |_| 0.0)
    }

    /// As [`Self::settle`], for an overload that grew steadily over the step: the slip snapped when
    /// the static limit was reached, and what the shear force exceeds it by has built up since.
    pub fn settle_driven(
        &self,
        object: &Object,
        tip: &Tip,
        anchor: Anchor,
    ) -> Option<(Anchor, DVec3)> {
        self.slip(object, tip, anchor, |excess| excess)
    }

    /// Lets an anchor slip until its shear force is the kinetic limit and what has been `rebuilt`
    /// since, given how far the static limit is exceeded (N).
    fn slip(
        &self,
        object: &Object,
        tip: &Tip,
        anchor: Anchor,
        rebuilt: impl Fn(f64) -> f64,
    ) -> Option<(Anchor, DVec3)> {
        let mut force = self.elastic_force(tip, anchor.position);
        let (mut normal_force, mut shear) = split(force, anchor.normal);
        if normal_force <= 0.0 {
            return None;
        }
        let excess = shear.length() - self.static_friction * normal_force;
        if excess <= SLIP_TOLERANCE * normal_force {
            return Some((anchor, force));
        }
        let mut anchor = anchor;
        let most = self.static_friction - self.kinetic_friction;
        for _ in 0..MAX_SLIP_ITERATIONS {
            let end =
                self.kinetic_friction * normal_force + rebuilt(excess).min(most * normal_force);
            let excess = shear.length() - end;
            if excess <= SLIP_TOLERANCE * normal_force {
                break;
            }
            anchor = self.slide(object, tip.axis, anchor, excess, shear)?;
            force = self.elastic_force(tip, anchor.position);
            (normal_force, shear) = split(force, anchor.normal);
            if normal_force <= 0.0 {
                return None;
            }
        }
        Some((anchor, force))
    }

    /// The anchor moved along its `shear` force until, to first order, that has lost its `excess`
    /// (N) over the kinetic limit, and put back on the surface.
    fn slide(
        &self,
        object: &Object,
        axis: DVec3,
        anchor: Anchor,
        excess: f64,
        shear: DVec3,
    ) -> Option<Anchor> {
        let direction = shear.normalize_or_zero();
        let relief = self.stiffness_times(axis, direction);
        // Sliding also changes the normal force where the feeler leans; never let that turn the
        // linear model's sign.
        let along = direction.dot(relief);
        let slope = along + self.kinetic_friction * anchor.normal.dot(relief);
        let distance = excess / slope.max(0.1 * along);
        let surface = object.nearest(anchor.position + distance * direction)?;
        Some(Anchor {
            position: surface.position + self.tip_radius * surface.normal,
            normal: surface.normal,
        })
    }
}

/// Splits a force on the object into its normal force (positive when it presses) and its shear.
fn split(force: DVec3, normal: DVec3) -> (f64, DVec3) {
    let normal_force = -force.dot(normal);
    (normal_force, force + normal_force * normal)
}
