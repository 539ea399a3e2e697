//! Slips of a block's contacts in structure-of-arrays form, for vectorized return mapping of [`Slip`]s.

use super::columnar_feeler::{Anchor, Overload, Tip};
use super::contacts::{BLOCK, Column, Vectors};
use super::feeler_config::{FeelerConfig, Friction};
use super::slip::{MAX_SLIP_ITERATIONS, Slip, Slipped, lost};
use crate::shapes::shape::Side;
use crate::shapes::surface_point::SurfacePoint;
use glam::DVec3;

/// Selection of contacts of a block.
pub(crate) type Mask = [bool; BLOCK];

/// Parameters common to all slips of a block.
#[derive(Clone, Copy)]
pub(crate) struct Alike<'a> {
    pub feeler: &'a FeelerConfig,
    pub friction: Friction,
    pub overload: Overload,
    /// Side surface of the cylinder.
    pub side: Side,
    /// Centre of the cylinder in the object's frame (m).
    pub centre: DVec3,
}

/// The slips of a block, one per lane.
#[derive(Clone, Copy, Default)]
pub(crate) struct Slips {
    position: Vectors,
    normal: Vectors,
    force: Vectors,
    direction: Vectors,
    normal_force: Column,
    shear: Column,
    bend: Column,
    rebuilt: Column,
    /// Slip distance (m).
    way: Column,
    /// Energy dissipated by friction (J).
    work: Column,
}

impl Slips {
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Slip {
        Slip {
            anchor: Anchor {
                position: self.position.get(lane),
                normal: self.normal.get(lane),
            },
            force: self.force.get(lane),
            normal_force: self.normal_force[lane],
            direction: self.direction.get(lane),
            shear: self.shear[lane],
            bend: self.bend[lane],
            rebuilt: self.rebuilt[lane],
        }
    }

    /// Distance and dissipation of a slip.
    #[inline(always)]
    pub fn slipped(&self, lane: usize) -> Slipped {
        Slipped {
            way: self.way[lane],
            work: self.work[lane],
        }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, slip: &Slip) {
        self.position.set(lane, slip.anchor.position);
        self.normal.set(lane, slip.anchor.normal);
        self.force.set(lane, slip.force);
        self.normal_force[lane] = slip.normal_force;
        self.direction.set(lane, slip.direction);
        self.shear[lane] = slip.shear;
        self.bend[lane] = slip.bend;
        self.rebuilt[lane] = slip.rebuilt;
    }
}

/// Return mapping of the contacts in `lanes` that `slips` selects, from the tips and anchors of `start`, each as in
/// [`FeelerConfig::settle`]. Also returns a mask of the resolved contacts: the selected ones, except those that left
/// the cylinder's side.
#[inline(always)]
#[expect(
    clippy::needless_range_loop,
    reason = "an iterator over one of the columns keeps the compiler from working on them side by side"
)]
pub(crate) fn slip_together(
    alike: Alike,
    lanes: usize,
    slips: &Mask,
    start: impl Fn(usize) -> (Tip, Anchor),
) -> (Slips, Mask) {
    let Alike {
        feeler, friction, ..
    } = alike;
    let curvature = alike.side.curvature(feeler.tip_radius);
    let mut now = Slips::default();
    let (mut tips, mut axes) = (Vectors::default(), Vectors::default());
    let (mut known, mut goes_on) = (*slips, *slips);
    for lane in 0..lanes.min(BLOCK) {
        let (tip, anchor) = start(lane);
        let slip = Slip::begin(feeler, friction, &tip, anchor, alike.overload);
        now.set(lane, &slip);
        tips.set(lane, tip.position);
        axes.set(lane, tip.axis);
        goes_on[lane] &= !slip.is_over(friction);
    }
    for _ in 0..MAX_SLIP_ITERATIONS {
        if !goes_on.contains(&true) {
            break;
        }
        for lane in 0..lanes.min(BLOCK) {
            let (slip, goes) = (now.get(lane), goes_on[lane]);
            let tip = Tip {
                position: tips.get(lane),
                axis: axes.get(lane),
                set: DVec3::ZERO,
            };
            let point = slip.ahead(feeler, friction, &tip);
            let (surface, is_beside) = alike.side.nearest(point - alike.centre);
            let anchor = feeler.anchor(&SurfacePoint {
                position: surface.position + alike.centre,
                ..surface
            });
            let next = slip.go_on(feeler, &tip, anchor, curvature);
            now.set(lane, if goes { &next } else { &slip });
            known[lane] &= !goes | is_beside;
            goes_on[lane] = goes & is_beside & (next.normal_force > 0.0) & !next.is_over(friction);
        }
    }
    let (mut way, mut work) = ([0.0; BLOCK], [0.0; BLOCK]);
    for lane in 0..lanes.min(BLOCK) {
        let (tip, anchor) = start(lane);
        let slipped = lost(feeler, &tip, &anchor, &now.get(lane).anchor);
        (way[lane], work[lane]) = (slipped.way, slipped.work);
    }
    (now.way, now.work) = (way, work);
    (now, known)
}
