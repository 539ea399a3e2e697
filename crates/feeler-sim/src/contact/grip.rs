//! Load (force or torque) of the feelers on an object along a degree of freedom, and its derivative with respect to the
//! displacement of the object.

use super::columnar_feeler::{Anchor, Tip, split, tip_of, within_cone};
use super::contacts::{BLOCK, Block, Column, Share};
use super::feeler_config::{FeelerConfig, Friction};
use super::settle::friction;
use crate::objects::object::Object;
use crate::objects::pose::Pose;
use crate::objects::thread::FingerLoad;
use crate::world::model::{Finger, WorldModel};
use crate::world::state::{FingerState, ObjectState};
use glam::DVec3;

/// Degree of freedom of an object, in its own frame.
#[derive(Clone, Copy)]
pub(crate) enum Freedom {
    /// Translation along a direction.
    Along(DVec3),
    /// Rotation about the object's z axis, with this descent per angle (m/rad).
    Around(f64),
}

/// Load of the feelers on an object along a degree of freedom, for the pose `seen` of each fingertip in the object's
/// frame. Feelers stick up to their static friction limit.
#[inline(always)]
pub(crate) fn grip(
    model: &WorldModel,
    fingers: &[FingerState],
    own: &ObjectState,
    index: usize,
    seen: impl Fn(&FingerState) -> Pose,
    freedom: Freedom,
) -> FingerLoad {
    let mut sum = FingerLoad {
        room: f64::INFINITY,
        ..FingerLoad::default()
    };
    for (finger, state) in model.fingers.iter().zip(fingers) {
        let contacts = state.contacts.on(index);
        if contacts.is_empty() {
            continue;
        }
        let seen = seen(state);
        let fingertip = Fingertip {
            finger,
            object: &model.objects[index],
            own,
            seen,
            turned: seen.turn_since(&state.rolled[index]),
        };
        for (share, block) in contacts.blocks() {
            let grips = match &finger.springs {
                Some(spring) => fingertip.springs(&spring.as_spring(), share, block, freedom),
                None => fingertip.feelers(&state.sets, model.step, share, block, freedom),
            };
            for lane in 0..share.count {
                sum.load += grips.load[lane];
                sum.stiffness += grips.stiffness[lane];
                sum.firm += grips.firm[lane];
                sum.room = sum.room.min(grips.room[lane]);
            }
        }
    }
    sum
}

/// A fingertip in contact with an object.
struct Fingertip<'a> {
    finger: &'a Finger,
    object: &'a Object,
    own: &'a ObjectState,
    /// Pose of the fingertip in the object's frame.
    seen: Pose,
    /// Rotation vector of the fingertip since the anchors were last updated for rolling, in the object's frame (rad).
    turned: DVec3,
}

/// Loads of a block's feelers, one per lane.
#[derive(Clone, Copy, Default)]
struct Grips {
    load: Column,
    stiffness: Column,
    firm: Column,
    room: Column,
}

impl Grips {
    #[inline(always)]
    fn set(&mut self, lane: usize, grip: &FingerLoad) {
        self.load[lane] = grip.load;
        self.stiffness[lane] = grip.stiffness;
        self.firm[lane] = grip.firm;
        self.room[lane] = grip.room;
    }
}

impl Fingertip<'_> {
    /// Computes the loads of a block of feelers that are identical pure springs; vectorized.
    #[inline(always)]
    #[expect(
        clippy::needless_range_loop,
        reason = "an iterator over one of the columns keeps the compiler from working on them side by side"
    )]
    fn springs(
        &self,
        spring: &FeelerConfig,
        share: Share,
        block: &Block,
        freedom: Freedom,
    ) -> Grips {
        let friction = friction(spring, self.object, self.own);
        let (seen, turned, dome_radius) = (self.seen, self.turned, self.finger.dome_radius);
        let mut held = Grips::default();
        let mut slips = [false; BLOCK];
        for lane in 0..share.lanes.min(BLOCK) {
            let anchor = spring.rolled(&block.anchor(lane), turned);
            let tip = tip_of(dome_radius, &seen, block.axis.get(lane), DVec3::ZERO);
            let (grip, holds) =
                contact_grip::<false>(spring, friction, &tip, &anchor, STILL, freedom);
            held.set(lane, &grip);
            slips[lane] = !holds & (lane < share.count);
        }
        if !slips.iter().fold(false, |any, &slips| any | slips) {
            return held;
        }
        let mut limited = Grips::default();
        for lane in 0..share.lanes.min(BLOCK) {
            let anchor = spring.rolled(&block.anchor(lane), turned);
            let tip = tip_of(dome_radius, &seen, block.axis.get(lane), DVec3::ZERO);
            let (grip, _) = contact_grip::<true>(spring, friction, &tip, &anchor, STILL, freedom);
            limited.set(lane, &grip);
        }
        limited
    }

    /// Computes the grips of feelers that differ from each other, one at a time. `duration` is the time since their tips were
    /// stored (s).
    fn feelers(
        &self,
        sets: &[DVec3],
        duration: f64,
        share: Share,
        block: &Block,
        freedom: Freedom,
    ) -> Grips {
        let mut grips = Grips::default();
        for lane in 0..share.count {
            let element = block.element[lane];
            let feeler = &self.finger.feelers[element];
            let anchor = feeler.rolled(&block.anchor(lane), self.turned);
            let tip = self.finger.undeformed(sets, &self.seen, element);
            let moved = (tip.position - block.tip_before.get(lane), duration);
            let friction = friction(feeler, self.object, self.own);
            let (mut grip, _) =
                contact_grip::<true>(feeler, friction, &tip, &anchor, moved, freedom);
            // A nonlinear feeler may become stiffer as it moves.
            if !feeler.is_spring() {
                grip.room = 0.0;
            }
            grips.set(lane, &grip);
        }
        grips
    }
}

/// Displacement (m) and duration (s) for a tip that does not move.
const STILL: (DVec3, f64) = (DVec3::ZERO, 1.0);

/// Load of one feeler along a degree of freedom, and `true` if it sticks. If it does not stick, the load is computed
/// from the limited force with `SLIPS`, otherwise from the trial force of a sticking contact. `moved` is the tip's
/// displacement (m) and its duration (s).
#[inline(always)]
fn contact_grip<const SLIPS: bool>(
    feeler: &FeelerConfig,
    friction: Friction,
    tip: &Tip,
    anchor: &Anchor,
    (moved, duration): (DVec3, f64),
    freedom: Freedom,
) -> (FingerLoad, bool) {
    let mut force = feeler.elastic_force(tip, anchor.position);
    let point = feeler.contact_point(anchor);
    let stretch = tip.position - anchor.position - tip.set;
    // Per rate of the degree of freedom, with the finger at rest: velocity of the contact point, decrease of that
    // velocity as the object moves, and decrease of the force.
    let (way, way_turns, mut force_falls) = match freedom {
        Freedom::Along(way) => (way, DVec3::ZERO, feeler.stiffness_times(tip.axis, way)),
        Freedom::Around(sinking) => {
            // In the object's frame the tip and its axis turn and the tip rolls, so the force's lever arm changes, too.
            let tip_moves = z_cross(point + stretch) - sinking * DVec3::Z;
            let axis_turns = z_cross(tip.axis);
            let turns = axis_turns.dot(stretch) * tip.axis + tip.axis.dot(stretch) * axis_turns;
            let stiffer = feeler.normal_stiffness - feeler.shear_stiffness;
            let force_falls = feeler.stiffness_times(tip.axis, tip_moves) + stiffer * turns;
            let arm_grows = feeler.tip_radius * anchor.normal.with_z(0.0);
            (z_cross(point), arm_grows, force_falls)
        }
    };
    if feeler.is_damped() {
        let velocity = moved / duration;
        force = within_cone(force, anchor.normal, friction);
        force += feeler.damping_times(tip.axis, velocity);
        force_falls += feeler.damping_times(tip.axis, way) / duration;
    }
    let (normal_force, shear) = split(force, anchor.normal);
    let most = friction.static_friction * normal_force;
    let spare = most * most - shear.length_squared();
    let holds = (normal_force > 0.0) & (spare >= 0.0);
    let (held, held_falls) = (force, force_falls);
    if SLIPS {
        let (slipping, slipping_falls) = at_limit(force, force_falls, anchor.normal, friction);
        force = select(holds, force, slipping);
        force_falls = select(holds, force_falls, slipping_falls);
    }
    // The 1-norm is an upper bound of the length, and vectorizes.
    let fastest = held_falls.abs().element_sum();
    let spare_falls = 2.0 * (shear.abs().element_sum() + friction.static_friction * most.abs());
    let grip = FingerLoad {
        load: way.dot(force),
        stiffness: way.dot(force_falls) - way_turns.dot(force),
        firm: (way.dot(held_falls) - way_turns.dot(held)).max(0.0),
        room: (spare.abs() / spare_falls).min(normal_force.abs()) / fastest,
    };
    (grip, holds)
}

/// Force on the object (N) by a feeler whose contact slips or is under tension, and its decrease per motion of the
/// object. `force` and `force_falls` are those of a sticking contact.
#[inline(always)]
fn at_limit(force: DVec3, force_falls: DVec3, normal: DVec3, friction: Friction) -> (DVec3, DVec3) {
    let (normal_force, shear) = split(force, normal);
    let (normal_falls, shear_falls) = split(force_falls, normal);
    // The shear force stays at the limit and turns with the direction of the sticking shear force.
    let per_length = shear.length().recip();
    let direction = per_length * shear;
    let turns = shear_falls - direction.dot(shear_falls) * direction;
    let most = friction.static_friction * normal_force;
    let shear_falls =
        friction.static_friction * normal_falls * direction + most * per_length * turns;
    let presses = normal_force > 0.0;
    let force = most * direction - normal_force * normal;
    let force_falls = shear_falls - normal_falls * normal;
    (
        select(presses, force, DVec3::ZERO),
        select(presses, force_falls, DVec3::ZERO),
    )
}

/// Selects a vector by components: a branch would prevent vectorization.
#[inline(always)]
fn select(first: bool, one: DVec3, other: DVec3) -> DVec3 {
    let pick = |one, other| if first { one } else { other };
    DVec3::new(
        pick(one.x, other.x),
        pick(one.y, other.y),
        pick(one.z, other.z),
    )
}

/// Cross product of the unit vector along z and `vector`.
#[inline(always)]
fn z_cross(vector: DVec3) -> DVec3 {
    DVec3::new(-vector.y, vector.x, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::pose::Screw;
    use glam::DMat3;

    /// Load of an inclined feeler on the side of an object that has turned by `angle` (rad), descending by 0.5 mm/rad.
    fn after(angle: f64, static_friction: f64) -> FingerLoad {
        let feeler = FeelerConfig::default();
        let sinking = 0.5e-3;
        let fingertip = Pose {
            position: DVec3::new(0.033, 0.002, 0.001),
            rotation: DMat3::from_rotation_y(-2.9) * DMat3::from_rotation_x(0.2),
        };
        let (sine, cosine) = angle.sin_cos();
        let screw = Screw {
            sine,
            cosine,
            advance: -sinking * angle,
        };
        let seen = screw.seen_after(&fingertip);
        let axis = DVec3::new(0.98, 0.1, -0.17).normalize();
        let tip = |seen| tip_of(0.019, seen, axis, DVec3::ZERO);
        // Compressed by 0.8 mm and sheared by 0.5 mm.
        let normal = DVec3::new(0.96, 0.28, 0.0);
        let aside = DVec3::new(-0.07, 0.24, 0.43);
        let anchor = Anchor {
            position: tip(&fingertip).position + 1e-3 * (0.8 * normal + aside),
            normal,
        };
        let anchor = feeler.rolled(&anchor, seen.turn_since(&fingertip.rotation));
        let friction = Friction {
            static_friction,
            ..feeler.friction()
        };
        let freedom = Freedom::Around(sinking);
        contact_grip::<true>(&feeler, friction, &tip(&seen), &anchor, STILL, freedom).0
    }

    #[test]
    fn stiffness_is_the_derivative_of_the_load_in_stick_and_slip() {
        // High friction, where the feeler sticks, and low friction, where it slips.
        for static_friction in [5.0, 0.2] {
            let grip = after(0.0, static_friction);
            assert!(grip.load.abs() > 1e-4, "{grip:?}");
            // The truncation error of central differences is of order h^2, the rounding error 1e-16 / h of the load.
            let h = 1e-5;
            let load = |angle| after(angle, static_friction).load;
            let falls = (load(-h) - load(h)) / (2.0 * h);
            assert!(
                (falls - grip.stiffness).abs() < 1e-6 * grip.firm,
                "{falls} N m/rad, not {grip:?}"
            );
            let holds = static_friction > 1.0;
            assert_eq!(
                holds,
                (grip.stiffness - grip.firm).abs() < 1e-12,
                "{grip:?}"
            );
        }
    }

    #[test]
    fn a_feeler_neither_slips_nor_sticks_within_its_room() {
        // Over the range of friction coefficients the contact changes from slip to stick. Steps next to the change are
        // near the limit.
        for step in 1..200 {
            let static_friction = 0.01 * f64::from(step);
            let slips = |grip: &FingerLoad| (grip.stiffness - grip.firm).abs() > 1e-12;
            let grip = after(0.0, static_friction);
            // `room` is a first-order estimate, with a relative error of about 0.1 % at this size.
            let way = 0.9 * grip.room.min(1e-3);
            for angle in [-way, way] {
                assert_eq!(
                    slips(&after(angle, static_friction)),
                    slips(&grip),
                    "{static_friction}"
                );
            }
        }
    }
}
