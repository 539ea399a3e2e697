//! Stick-slip return mapping of one contact: slides the anchor until the shear force is back within its limit.

use super::columnar_feeler::{Anchor, Overload, Tip, split};
use super::feeler_config::{FeelerConfig, Friction};
use crate::objects::object::Object;
use glam::DVec3;

/// Maximum number of Newton steps along the surface; on a cylinder two or three suffice.
pub(crate) const MAX_SLIP_ITERATIONS: usize = 16;
/// Tolerance of the final shear force above the limit, as a fraction of the normal force. On a cylinder it also applies
/// below the limit.
const SLIP_TOLERANCE: f64 = 1e-9;

/// Returns `true` if a tip with `normal_force` sticks under a `shear` force (both in N).
#[inline(always)]
pub(crate) fn sticks(normal_force: f64, shear: f64, friction: Friction) -> bool {
    let excess = shear - friction.static_friction * normal_force;
    excess <= SLIP_TOLERANCE * normal_force
}

/// State of a slip. All vectors are in the object's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slip {
    /// Current anchor of the tip.
    pub anchor: Anchor,
    /// Force on the object (N).
    pub force: DVec3,
    /// Normal component of the force (N).
    pub normal_force: f64,
    /// Magnitude of the shear component (N).
    pub shear: f64,
    /// Direction of the shear force, and of the slip.
    pub direction: DVec3,
    /// Curvature of the surface along the slip (1/m) on the side of a cylinder; 0 elsewhere. A step that assumes a flat
    /// surface does not overshoot on a convex one, and so does not cross an edge.
    pub bend: f64,
    /// Residual shear force above the kinetic limit at the end of the slip (N), before limiting to the static limit.
    pub rebuilt: f64,
}

impl Slip {
    /// Starts the slip of a feeler whose shear force at `anchor` exceeds the static limit. The first step assumes a
    /// flat surface and stops short; the next ones follow the local shear direction.
    #[inline(always)]
    pub fn begin(
        feeler: &FeelerConfig,
        friction: Friction,
        tip: &Tip,
        anchor: Anchor,
        overload: Overload,
    ) -> Self {
        let slip = Self::at(feeler, tip, anchor, 0.0);
        let rebuilt = match overload {
            Overload::Steady => slip.shear - friction.static_friction * slip.normal_force,
            Overload::Sudden => 0.0,
        };
        Self { rebuilt, ..slip }
    }

    /// Shear force above the final value of the slip (N).
    #[inline(always)]
    fn excess(&self, friction: Friction) -> f64 {
        let most = friction.static_friction - friction.kinetic_friction;
        let left = self.rebuilt.min(most * self.normal_force);
        self.shear - (friction.kinetic_friction * self.normal_force + left)
    }

    #[inline(always)]
    pub fn is_over(&self, friction: Friction) -> bool {
        let (excess, tolerance) = (self.excess(friction), SLIP_TOLERANCE * self.normal_force);
        excess <= tolerance && (self.bend == 0.0 || excess >= -tolerance)
    }

    /// Newton step to zero excess: position of the tip (m) if the surface were flat.
    #[inline(always)]
    pub fn ahead(&self, feeler: &FeelerConfig, friction: Friction, tip: &Tip) -> DVec3 {
        let relief = feeler.stiffness_times(tip.axis, self.direction);
        let stiffness = self.direction.dot(relief);
        // Slipping also changes the normal force if the feeler is inclined or the surface is curved.
        let shear_falls = stiffness - self.bend * self.normal_force;
        let normal_falls = -self.anchor.normal.dot(relief) + self.bend * self.shear;
        let most = friction.static_friction - friction.kinetic_friction;
        let is_limited = self.rebuilt > most * self.normal_force;
        let coefficient = if is_limited {
            friction.static_friction
        } else {
            friction.kinetic_friction
        };
        let slope = shear_falls - coefficient * normal_falls;
        // Keeps the slope of the linear model positive.
        let way = self.excess(friction) / slope.max(0.1 * stiffness);
        self.anchor.position + way * self.direction
    }

    /// The slip after it has moved to `anchor`. `curvature` (1/m) is the curvature of the path of tips around a
    /// cylinder, and 0 on other shapes.
    #[inline(always)]
    pub fn go_on(&self, feeler: &FeelerConfig, tip: &Tip, anchor: Anchor, curvature: f64) -> Self {
        Self {
            rebuilt: self.rebuilt,
            ..Self::at(feeler, tip, anchor, curvature)
        }
    }

    #[inline(always)]
    fn at(feeler: &FeelerConfig, tip: &Tip, anchor: Anchor, curvature: f64) -> Self {
        let force = feeler.elastic_force(tip, anchor.position);
        let (normal_force, across) = split(force, anchor.normal);
        let shear = across.length();
        let direction = across / shear;
        let around = direction.x * direction.x + direction.y * direction.y;
        let is_beside = anchor.normal.z == 0.0;
        Self {
            anchor,
            force,
            normal_force,
            shear,
            direction,
            bend: if is_beside { curvature * around } else { 0.0 },
            rebuilt: 0.0,
        }
    }
}

impl FeelerConfig {
    /// Stick-slip return mapping: returns the anchor and the force on the object (N), in the object's frame, after
    /// slipping if the shear force exceeds the static friction limit. `None` if the normal force is not compressive, so
    /// that the contact separates.
    ///
    /// The feeler has no mass, so a slip completes within the step: the shear force falls to the kinetic limit, and the
    /// tip sticks again. Drives are slow compared with slips, so under steady motion the shear force is a sawtooth
    /// between both limits.
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

/// Distance and dissipation of a slip.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slipped {
    /// Distance that the tip has slid, without rolling (m).
    pub way: f64,
    /// Energy dissipated by friction (J).
    pub work: f64,
}

/// Distance and dissipation of a slip from one anchor to another. The feeler has no mass and its force falls linearly,
/// so friction dissipates the mean force times the distance: the spring's loss of energy.
#[inline(always)]
pub(crate) fn lost(feeler: &FeelerConfig, tip: &Tip, from: &Anchor, to: &Anchor) -> Slipped {
    let way = to.position - from.position;
    let before = feeler.elastic_force(tip, from.position);
    let after = feeler.elastic_force(tip, to.position);
    Slipped {
        way: way.length(),
        work: 0.5 * (before + after).dot(way),
    }
}
