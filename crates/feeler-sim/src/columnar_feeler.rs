//! Contact of one feeler: an anisotropic spring between its undeformed tip and an anchor on the
//! object's surface, held there by friction (design, section 8).

pub use super::feeler_config::{FeelerConfig, Friction};

use super::object::Object;
use super::pose::Pose;
use super::shape::SurfacePoint;
use super::slip::{MAX_SLIP_ITERATIONS, Slip, sticks};
use glam::DVec3;

/// A feeler that is compressed beyond its length limit is stiffer by this factor.
const BOTTOMED_FACTOR: f64 = 10.0;

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
    /// The feeler's set: by how much its tip stays behind without any force, m, in the object's
    /// frame. Zero where the feeler does not relax.
    pub set: DVec3,
}

impl Tip {
    /// Centre of the tip's sphere while nothing touches it, m, in the object's frame.
    pub fn at_rest(&self) -> DVec3 {
        self.position - self.set
    }
}

/// The undeformed feeler along `axis` in the fingertip frame `T`, with its `set` (m) in the object's, on a dome of `dome_radius` (m)
/// that is at `seen` as seen from the object.
#[inline(always)]
pub(super) fn tip_of(dome_radius: f64, seen: &Pose, axis: DVec3, set: DVec3) -> Tip {
    let axis = seen.rotation * axis;
    Tip {
        position: seen.position + dome_radius * axis,
        axis,
        set,
    }
}

/// How an overload of a feeler came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Overload {
    /// It grew steadily over the step: the slip snapped when the static limit was reached, and what
    /// the shear force exceeds that by has built up since.
    Steady,
    /// At a stroke, by another feeler's slip: the shear force falls to the kinetic limit.
    Sudden,
}

impl FeelerConfig {
    /// Friction of this feeler on an object that brings none of its own.
    #[inline(always)]
    pub fn friction(&self) -> Friction {
        Friction {
            static_friction: self.static_friction,
            kinetic_friction: self.kinetic_friction,
            stribeck_speed: self.stribeck_speed,
        }
    }

    /// Whether the feeler is damped at all.
    #[inline(always)]
    pub fn is_damped(&self) -> bool {
        self.normal_damping > 0.0 || self.shear_damping > 0.0
    }

    /// Force on the object by a feeler whose tip is held at `anchor`, N, in the object's frame.
    ///
    /// With displacement `d` of the undeformed tip from the anchor, `d_n` along the axis and `d_t`
    /// across it, it is the gradient of `k_n d_n² / 2 + k_t (1 + c d_n) d_t² / 2`, and beyond the
    /// length limit L of `(10 - 1) k_n (d_n - L)² / 2` more. A set is taken off the displacement for
    /// the linear part of the force, `K d`, and for no other.
    #[inline(always)]
    pub fn elastic_force(&self, tip: &Tip, anchor: DVec3) -> DVec3 {
        let displacement = tip.position - anchor;
        let force = self.stiffness_times(tip.axis, displacement - tip.set);
        if self.normal_shear_coupling == 0.0 && self.length_limit.is_none() {
            return force;
        }
        let along = tip.axis.dot(displacement).max(0.0);
        let across = displacement - tip.axis.dot(displacement) * tip.axis;
        let coupled = self.normal_shear_coupling * self.shear_stiffness;
        let beyond = self.length_limit.map_or(0.0, |l| (along - l).max(0.0));
        let bottomed = (BOTTOMED_FACTOR - 1.0) * self.normal_stiffness * beyond;
        let pressed = if along > 0.0 {
            0.5 * coupled * across.length_squared()
        } else {
            0.0
        };
        force + coupled * along * across + (pressed + bottomed) * tip.axis
    }

    /// The stiffness matrix `K = k_t I + (k_n - k_t) n n^T` of a feeler along `axis`, times
    /// `displacement` (m); N.
    #[inline(always)]
    pub fn stiffness_times(&self, axis: DVec3, displacement: DVec3) -> DVec3 {
        self.shear_stiffness * displacement
            + (self.normal_stiffness - self.shear_stiffness) * axis.dot(displacement) * axis
    }

    /// The damping matrix, made like the stiffness matrix, times `velocity` (m/s); N.
    #[inline(always)]
    pub fn damping_times(&self, axis: DVec3, velocity: DVec3) -> DVec3 {
        self.shear_damping * velocity
            + (self.normal_damping - self.shear_damping) * axis.dot(velocity) * axis
    }

    /// The anchor of a tip that touches `surface`.
    #[inline(always)]
    pub fn anchor(&self, surface: &SurfacePoint) -> Anchor {
        Anchor {
            position: surface.position + self.tip_radius * surface.normal,
            normal: surface.normal,
        }
    }

    /// `anchor` after the tip has rolled by `turn` (rad, of the fingertip against the object, in the
    /// object's frame) without slipping, as if the surface were flat.
    ///
    /// The tip's sphere turns with the fingertip and not with the object: what turns under it makes
    /// it roll, and the contact point stays on the same spot of neither.
    #[inline(always)]
    pub fn rolled(&self, anchor: &Anchor, turn: DVec3) -> Anchor {
        Anchor {
            position: anchor.position + self.tip_radius * turn.cross(anchor.normal),
            normal: anchor.normal,
        }
    }

    /// Where a tip held at `anchor` touches the surface, m, in the object's frame.
    #[inline(always)]
    pub fn contact_point(&self, anchor: &Anchor) -> DVec3 {
        anchor.position - self.tip_radius * anchor.normal
    }

    /// Lets an anchor slip if its shear force exceeds the static friction limit, and gives it up if
    /// it would pull: the anchor that remains and the force on the object by the feeler, N, in the
    /// object's frame.
    ///
    /// The feeler has no mass: a slip snaps within the step, the shear force falling to the kinetic
    /// limit, and there the tip sticks again. (The drive is slow against the snap, so the tip is
    /// at rest whenever it is not snapping; the shear force makes a sawtooth between both limits.)
    pub fn settle(
        &self,
        object: &Object,
        friction: Friction,
        tip: &Tip,
        anchor: Anchor,
        overload: Overload,
    ) -> Option<(Anchor, DVec3)> {
        let force = self.elastic_force(tip, anchor.position);
        let (normal_force, shear) = split(force, anchor.normal);
        if normal_force <= 0.0 {
            return None;
        }
        if sticks(normal_force, shear.length(), friction) {
            return Some((anchor, force));
        }
        let side = object.shape.side();
        let curvature = side.map_or(0.0, |side| side.curvature(self.tip_radius));
        let mut slip = Slip::begin(self, friction, tip, anchor, overload);
        for _ in 0..MAX_SLIP_ITERATIONS {
            if slip.is_over(friction) {
                break;
            }
            let point = slip.ahead(self, friction, tip);
            let anchor = self.anchor(&object.nearest(point)?);
            slip = slip.go_on(self, tip, anchor, curvature);
            if slip.normal_force <= 0.0 {
                return None;
            }
        }
        Some((slip.anchor, slip.force))
    }
}

/// `force` (N, on the object), its shear cut at the static friction limit; zero where it pulls.
#[inline(always)]
pub fn within_cone(force: DVec3, normal: DVec3, friction: Friction) -> DVec3 {
    let (normal_force, shear) = split(force, normal);
    if normal_force <= 0.0 {
        return DVec3::ZERO;
    }
    shear.clamp_length_max(friction.static_friction * normal_force) - normal_force * normal
}

/// Splits a force on the object into its normal force (positive when it presses) and its shear.
#[inline(always)]
pub(super) fn split(force: DVec3, normal: DVec3) -> (f64, DVec3) {
    let normal_force = -force.dot(normal);
    (normal_force, force + normal_force * normal)
}
