//! How an overloaded feeler slips (design, section 8).

use super::columnar_feeler::{Anchor, FeelerConfig, Friction, Overload, Tip, split};
use glam::DVec3;

/// A slipping anchor is followed along the surface in steps; on a cylinder two or three suffice.
pub(super) const MAX_SLIP_ITERATIONS: usize = 16;
/// A slip ends when the shear force exceeds the kinetic limit by less than this fraction of the normal force; and on a cylinder, when it
/// falls short of it by less.
const SLIP_TOLERANCE: f64 = 1e-9;

/// Whether a tip that presses with `normal_force` sticks under a `shear` force, both N.
#[inline(always)]
pub(super) fn sticks(normal_force: f64, shear: f64, friction: Friction) -> bool {
    let excess = shear - friction.static_friction * normal_force;
    excess <= SLIP_TOLERANCE * normal_force
}

/// A slip on its way. All vectors are in the object's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slip {
    /// Where the tip is by now.
    pub anchor: Anchor,
    /// Force on the object there, N.
    pub force: DVec3,
    /// What of it presses, N.
    pub normal_force: f64,
    /// What of it is shear, N.
    pub shear: f64,
    /// The direction of that, along which the tip slips on.
    pub direction: DVec3,
    /// By how much the surface's normal turns on the way, along it, 1/m, where that is known: beside a cylinder. Else 0: as on a flat
    /// surface, a step on a convex one never goes too far, and so not over a corner, either.
    pub bend: f64,
    /// How much shear above the kinetic limit is left in the end, N, if the static limit allows that.
    pub rebuilt: f64,
}

impl Slip {
    /// That of a feeler whose shear at `anchor` is above the static limit. Its first step is that of a flat surface, which stops short: it goes on
    /// along the shear that it finds there.
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

    /// By how much the shear exceeds what the slip ends at, N.
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

    /// A Newton step to where nothing is left of the excess: where the tip is then if the surface is flat, m.
    #[inline(always)]
    pub fn ahead(&self, feeler: &FeelerConfig, friction: Friction, tip: &Tip) -> DVec3 {
        let relief = feeler.stiffness_times(tip.axis, self.direction);
        let stiffness = self.direction.dot(relief);
        // Slipping also changes the normal force, where the feeler leans and the surface bends.
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
        // The linear model's sign must never turn.
        let way = self.excess(friction) / slope.max(0.1 * stiffness);
        self.anchor.position + way * self.direction
    }

    /// The slip after it has gone on to `anchor`. `curvature` (1/m) is that of the way of tips around a cylinder, 0 on what is none.
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

/// What a slip took.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slipped {
    /// Way of the tip, m, without what it rolled.
    pub way: f64,
    /// Work that friction took, J.
    pub work: f64,
}

/// What a slip from one anchor to another took. The feeler has no mass and its force falls in proportion,
/// so that friction takes the mean of both forces times the way: all that the spring loses.
#[inline(always)]
pub(super) fn lost(feeler: &FeelerConfig, tip: &Tip, from: &Anchor, to: &Anchor) -> Slipped {
    let way = to.position - from.position;
    let before = feeler.elastic_force(tip, from.position);
    let after = feeler.elastic_force(tip, to.position);
    Slipped {
        way: way.length(),
        work: 0.5 * (before + after).dot(way),
    }
}
