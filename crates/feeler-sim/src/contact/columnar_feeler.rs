//! Contact of one feeler: an anisotropic spring between its undeformed tip and an anchor on the object's surface, which
//! Coulomb friction holds in place.

use super::feeler_config::{FeelerConfig, Friction};
use crate::objects::pose::Pose;
use crate::shapes::surface_point::SurfacePoint;
use glam::DVec3;

/// Factor on the normal stiffness of a feeler that is compressed beyond its length limit.
const BOTTOMED_FACTOR: f64 = 10.0;

/// Point where a feeler sticks to an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// Centre of the deformed tip's sphere in the object's frame (m).
    pub position: DVec3,
    /// Outward surface normal at the contact, in the object's frame.
    pub normal: DVec3,
}

/// Undeformed tip of a feeler relative to an object.
#[derive(Debug, Clone, Copy)]
pub struct Tip {
    /// Centre of the undeformed tip's sphere in the object's frame (m).
    pub position: DVec3,
    /// Axis of the feeler, outward from the dome; a unit vector in the object's frame.
    pub axis: DVec3,
    /// Creep displacement (*set*): offset by which the unloaded tip lags the undeformed one, in the object's frame (m).
    /// Zero for feelers that do not relax.
    pub set: DVec3,
}

impl Tip {
    /// Centre of the unloaded tip's sphere in the object's frame (m).
    pub fn at_rest(&self) -> DVec3 {
        self.position - self.set
    }
}

/// Undeformed tip of a feeler whose axis in the fingertip frame `T` is `axis` and whose creep displacement in the
/// object's frame is `set` (m). `seen` is the pose of the dome in the object's frame, and `dome_radius` its radius (m).
#[inline(always)]
pub(crate) fn tip_of(dome_radius: f64, seen: &Pose, axis: DVec3, set: DVec3) -> Tip {
    let axis = seen.rotation * axis;
    Tip {
        position: seen.position + dome_radius * axis,
        axis,
        set,
    }
}

/// Origin of a shear force above the static friction limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Overload {
    /// Steady motion over the step. The slip occurred when the limit was reached; the excess has built up again since.
    Steady,
    /// Another feeler's slip, instantaneously. The shear force falls to the kinetic limit.
    Sudden,
}

impl FeelerConfig {
    /// Friction of this feeler on an object that does not define its friction.
    #[inline(always)]
    pub fn friction(&self) -> Friction {
        Friction {
            static_friction: self.static_friction,
            kinetic_friction: self.kinetic_friction,
            stribeck_speed: self.stribeck_speed,
        }
    }

    /// Returns `true` if the feeler has any damping.
    #[inline(always)]
    pub fn is_damped(&self) -> bool {
        self.normal_damping > 0.0 || self.shear_damping > 0.0
    }

    /// Force on the object by a feeler whose tip is at `anchor`, in the object's frame (N).
    ///
    /// With displacement `d` of the undeformed tip from the anchor, `d_n` along the axis and `d_t` across it, the force
    /// is the gradient of `k_n d_n² / 2 + k_t (1 + c d_n) d_t² / 2`, plus `(10 - 1) k_n (d_n - L)² / 2` beyond the
    /// length limit L. The creep displacement is subtracted only in the linear part `K d`.
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

    /// Product of the stiffness matrix `K = k_t I + (k_n - k_t) n n^T` of a feeler along `axis`, and `displacement`
    /// (m); in N.
    #[inline(always)]
    pub fn stiffness_times(&self, axis: DVec3, displacement: DVec3) -> DVec3 {
        self.shear_stiffness * displacement
            + (self.normal_stiffness - self.shear_stiffness) * axis.dot(displacement) * axis
    }

    /// Product of the damping matrix, of the same form as the stiffness matrix, and `velocity` (m/s); in N.
    #[inline(always)]
    pub fn damping_times(&self, axis: DVec3, velocity: DVec3) -> DVec3 {
        self.shear_damping * velocity
            + (self.normal_damping - self.shear_damping) * axis.dot(velocity) * axis
    }

    /// Anchor of a tip that touches `surface`.
    #[inline(always)]
    pub fn anchor(&self, surface: &SurfacePoint) -> Anchor {
        Anchor {
            position: surface.position + self.tip_radius * surface.normal,
            normal: surface.normal,
        }
    }

    /// `anchor` after the tip has rolled by `turn` (rotation of the fingertip relative to the object, in the object's
    /// frame, rad) without slipping, on a locally flat surface.
    ///
    /// The tip's sphere turns with the fingertip. So the contact point moves on the surface and on the tip.
    #[inline(always)]
    pub fn rolled(&self, anchor: &Anchor, turn: DVec3) -> Anchor {
        Anchor {
            position: anchor.position + self.tip_radius * turn.cross(anchor.normal),
            normal: anchor.normal,
        }
    }

    /// Contact point on the surface of a tip at `anchor`, in the object's frame (m).
    #[inline(always)]
    pub fn contact_point(&self, anchor: &Anchor) -> DVec3 {
        anchor.position - self.tip_radius * anchor.normal
    }
}

/// Limits the shear of `force` (on the object, N) to the static friction cone. Zero if the force is tensile.
#[inline(always)]
pub fn within_cone(force: DVec3, normal: DVec3, friction: Friction) -> DVec3 {
    let (normal_force, shear) = split(force, normal);
    if normal_force <= 0.0 {
        return DVec3::ZERO;
    }
    shear.clamp_length_max(friction.static_friction * normal_force) - normal_force * normal
}

/// Splits a force on the object into the normal force (positive in compression) and the shear force.
#[inline(always)]
pub(crate) fn split(force: DVec3, normal: DVec3) -> (f64, DVec3) {
    let normal_force = -force.dot(normal);
    (normal_force, force + normal_force * normal)
}
