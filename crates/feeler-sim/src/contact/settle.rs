//! Resolves stick, slip and separation of all contacts with one object, and their forces.

use super::columnar_feeler::{Overload, split, tip_of, within_cone};
use super::contacts::{BLOCK, Block, Column, Share, Vectors};
use super::feeler_config::{FeelerConfig, Friction};
use super::slip::{Slipped, lost, sticks};
use super::slips::{Alike, Mask, Slips, slip_together};
use crate::objects::object::Object;
use crate::objects::pose::Pose;
use crate::world::model::{Finger, WorldModel};
use crate::world::state::{FingerState, ObjectState, State};
use glam::DVec3;
use multiversion::multiversion;

/// Current friction of a feeler on an object.
#[inline(always)]
pub(crate) fn friction(feeler: &FeelerConfig, object: &Object, state: &ObjectState) -> Friction {
    let friction = object.friction.unwrap_or_else(|| feeler.friction());
    friction.scaled(state.friction_factor)
}

/// Contacts of one finger with an object.
struct FingerContacts<'a> {
    finger: &'a Finger,
    object: &'a Object,
    state: &'a ObjectState,
    /// Pose of the fingertip in the object's frame.
    seen: Pose,
    /// Rotation of the fingertip since the anchors were last updated for rolling, in the object's frame (rad).
    turned: DVec3,
    overload: Overload,
    /// Time since [`remember_tips`] (s).
    duration: f64,
}

/// Trial forces of a block's contacts, before slipping.
struct Held {
    /// Forces on the object in W (N).
    force: Vectors,
    /// Compressed contacts that stick.
    is_held: Mask,
    /// Compressed contacts that slip.
    slips: Mask,
}

/// Force of a contact on the object in W (N), and its slip, if any.
type Settled = (DVec3, Option<Slipped>);

/// Resolves the contacts with an object, updates their forces and returns the number of slips and separations.
/// `duration` is the time since [`remember_tips`] (s).
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn settle(
    model: &WorldModel,
    state: &mut State,
    index: usize,
    overload: Overload,
    duration: f64,
) -> usize {
    let mut slips = 0;
    let (object, own) = (&model.objects[index], &state.objects[index]);
    for (finger, state) in model.fingers.iter().zip(&mut state.fingers) {
        if state.contacts.is_empty() {
            continue;
        }
        let seen = state.tip.relative_to(&own.pose);
        let turned = seen.turn_since(&state.rolled[index]);
        state.rolled[index] = seen.rotation;
        state.seen[index] = seen;
        let meeting = FingerContacts {
            finger,
            object,
            state: own,
            seen,
            turned,
            overload,
            duration,
        };
        let mut gone = false;
        let contacts = state.contacts.on_mut(index);
        for (share, block) in contacts.blocks_mut() {
            let held = meeting.hold(share, block);
            let together = meeting.slip_together(share, block, &held);
            for lane in 0..share.count {
                let element = block.element[lane];
                if held.is_held[lane] {
                    state.forces[element] = held.force.get(lane);
                    continue;
                }
                let settled = match &together {
                    Some((ended, known)) if known[lane] => meeting.slipped(block, lane, ended),
                    _ => meeting.settle(block, lane, &state.sets),
                };
                gone |= settled.is_none();
                let Some((force, slipped)) = settled else {
                    slips += 1;
                    state.forces[element] = DVec3::ZERO;
                    state.watch.due[element] = state.watch.travelled;
                    state.watch.soonest = state.watch.travelled;
                    continue;
                };
                if let Some(slipped) = slipped {
                    slips += 1;
                    state.slipped[element] += slipped.way;
                    state.slip_work += slipped.work;
                }
                state.forces[element] = force;
            }
        }
        if gone {
            // The bound is infinite for feelers in contact, and finite for separated ones.
            let due = &state.watch.due;
            contacts.retain(|element| due[element] == f64::INFINITY);
        }
    }
    slips
}

impl FingerContacts<'_> {
    /// Rolls the tips of a block on the object. If all feelers are identical pure springs, also computes the trial
    /// forces that the contacts exert if they stick, and the contacts that slip.
    #[inline(always)]
    fn hold(&self, share: Share, block: &mut Block) -> Held {
        let mut held = Held {
            force: Vectors::default(),
            is_held: [false; BLOCK],
            slips: [false; BLOCK],
        };
        let Some(spring) = &self.finger.springs else {
            for lane in 0..share.count {
                self.roll(block, lane, &self.finger.feelers[block.element[lane]]);
            }
            return held;
        };
        let spring = spring.as_spring();
        let friction = friction(&spring, self.object, self.state);
        let (mut pressed, mut shear): (Column, Column) = ([0.0; BLOCK], [0.0; BLOCK]);
        let mut anchors = Vectors::default();
        // Local copies: the compiler vectorizes only if inputs and outputs cannot alias.
        let (seen, turned, dome_radius) = (self.seen, self.turned, self.finger.dome_radius);
        let to_world = self.state.pose.rotation;
        for lane in 0..share.lanes.min(BLOCK) {
            let anchor = spring.rolled(&block.anchor(lane), turned);
            let tip = tip_of(dome_radius, &seen, block.axis.get(lane), DVec3::ZERO);
            let force = spring.elastic_force(&tip, anchor.position);
            let (normal_force, across) = split(force, anchor.normal);
            (pressed[lane], shear[lane]) = (normal_force, across.length());
            held.force.set(lane, to_world * force);
            anchors.set(lane, anchor.position);
        }
        block.roll_to(&anchors, spring.tip_radius * turned.length());
        for lane in 0..share.count {
            let sticks = sticks(pressed[lane], shear[lane], friction);
            held.is_held[lane] = pressed[lane] > 0.0 && sticks;
            held.slips[lane] = pressed[lane] > 0.0 && !sticks;
        }
        held
    }

    /// Return mapping of the slipping contacts of a block together. Also returns a mask of the contacts that it
    /// resolved. `None` unless several contacts slip on a cylinder.
    #[inline(always)]
    fn slip_together(&self, share: Share, block: &Block, held: &Held) -> Option<(Slips, Mask)> {
        if held.slips.iter().filter(|slips| **slips).count() < 2 {
            return None;
        }
        let spring = self.finger.springs.as_ref()?.as_spring();
        let friction = friction(&spring, self.object, self.state);
        if friction.stribeck_speed > 0.0 {
            return None;
        }
        let alike = Alike {
            feeler: &spring,
            friction,
            overload: self.overload,
            side: self.object.shape.side()?,
            centre: self.object.offset,
        };
        let (seen, dome_radius) = (self.seen, self.finger.dome_radius);
        let start = |lane| {
            let tip = tip_of(dome_radius, &seen, block.axis.get(lane), DVec3::ZERO);
            (tip, block.anchor(lane))
        };
        Some(slip_together(alike, share.lanes, &held.slips, start))
    }

    /// Applies the slip of a contact that [`slip_together`] has resolved. Same result as [`Self::settle`].
    fn slipped(&self, block: &mut Block, lane: usize, slips: &Slips) -> Option<Settled> {
        let slip = slips.get(lane);
        if slip.normal_force <= 0.0 {
            return None;
        }
        let slipped = (block.anchor(lane) != slip.anchor).then(|| slips.slipped(lane));
        block.set_anchor(lane, &slip.anchor);
        Some((self.state.pose.rotation * slip.force, slipped))
    }

    #[inline(always)]
    fn roll(&self, block: &mut Block, lane: usize, feeler: &FeelerConfig) {
        let anchor = feeler.rolled(&block.anchor(lane), self.turned);
        block.anchor.set(lane, anchor.position);
        block.rolled[lane] += feeler.tip_radius * self.turned.length();
    }

    /// Resolves one contact, whose tip has rolled. `None` if it separates.
    fn settle(&self, block: &mut Block, lane: usize, sets: &[DVec3]) -> Option<Settled> {
        let element = block.element[lane];
        let feeler = self.finger.feeler(element);
        let before = block.anchor(lane);
        let tip = self.finger.undeformed(sets, &self.seen, element);
        let mut friction = friction(feeler, self.object, self.state);
        let velocity = (tip.position - block.tip_before.get(lane)) / self.duration;
        if friction.stribeck_speed > 0.0 {
            friction = friction.at_speed(velocity.reject_from(before.normal).length());
        }
        let (anchor, mut force) =
            feeler.settle(self.object, friction, &tip, before, self.overload)?;
        let slipped = (before != anchor).then(|| lost(feeler, &tip, &before, &anchor));
        block.set_anchor(lane, &anchor);
        if feeler.is_damped() {
            force += feeler.damping_times(tip.axis, velocity);
            force = within_cone(force, anchor.normal, friction);
        }
        Some((self.state.pose.rotation * force, slipped))
    }
}

/// Stores the positions of the tips on an object, for speed-dependent forces.
pub(crate) fn remember_tips(model: &WorldModel, state: &mut State, index: usize) {
    if !model.depends_on_speed {
        return;
    }
    let pose = &state.objects[index].pose;
    for (finger, state) in model.fingers.iter().zip(&mut state.fingers) {
        let seen = state.tip.relative_to(pose);
        let FingerState { contacts, sets, .. } = state;
        for (share, block) in contacts.on_mut(index).blocks_mut() {
            for lane in 0..share.count {
                let tip = finger.undeformed(sets, &seen, block.element[lane]);
                block.tip_before.set(lane, tip.position);
            }
        }
    }
}
