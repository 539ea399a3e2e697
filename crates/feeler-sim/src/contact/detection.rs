//! Contact detection for free feelers, by conservative advancement, and projection of rolled tips onto their surface.

use super::contacts::Contact;
use crate::objects::object::Object;
use crate::objects::pose::Pose;
use crate::world::model::{Finger, WorldModel};
use crate::world::state::{FingerState, GROUP, ObjectState};
use feeler::hand::JointVector;
use glam::DVec3;

/// Maximum rolling distance along the tangent before a tip is projected onto the surface (m): on a radius of 10 mm
/// it is then off by 0.2 nm, and its normal by 0.2 mrad.
const FLAT: f64 = 2e-6;

/// Updates the contacts of a finger: projects rolled tips onto their surface, then adds contacts of feelers whose
/// tips have reached a surface.
pub(crate) fn touch(
    model: &WorldModel,
    finger: &Finger,
    own: &mut FingerState,
    objects: &[ObjectState],
) {
    let watch = &mut own.watch;
    let mut way = 0.0_f64;
    let seen = watch.seen.iter_mut().zip(&mut own.seen);
    for ((before, seen), object) in seen.zip(objects) {
        *seen = own.tip.relative_to(&object.pose);
        way = way.max(seen.motion_since(before, finger.dome_radius));
        *before = *seen;
    }
    watch.travelled += way;
    watch.unseen = 0.0;
    watch.moves = moves(objects);
    if own.contacts.is_empty() {
        for (rolled, seen) in own.rolled.iter_mut().zip(&watch.seen) {
            *rolled = seen.rotation;
        }
    } else {
        put_back(model, finger, own);
    }
    let watch = &mut own.watch;
    let travelled = watch.travelled;
    if watch.soonest > travelled {
        return;
    }
    let mut soonest = [f64::INFINITY; GROUP];
    let (groups, _) = watch.due.as_chunks_mut::<GROUP>();
    for (number, group) in groups.iter_mut().enumerate() {
        // Usually no feeler is due.
        if group
            .iter()
            .fold(false, |any, &due| any | (due <= travelled))
        {
            // The last group's padding has no elements; it is never due, unless the travelled distance is infinite.
            let elements = GROUP * number..finger.normals.len();
            for (element, due) in elements.zip(&mut *group) {
                if *due > travelled {
                    continue;
                }
                let (clearance, contact) =
                    look(finger, &own.sets, &model.objects, &watch.seen, element);
                *due = travelled + clearance;
                if let Some(contact) = contact {
                    own.contacts.push(&contact, finger.normals[element]);
                }
            }
        }
        for (soonest, &due) in soonest.iter_mut().zip(&*group) {
            *soonest = if due < *soonest { due } else { *soonest };
        }
    }
    watch.soonest = soonest.into_iter().fold(f64::INFINITY, f64::min);
}

/// Total number of motions of all objects.
pub(crate) fn moves(objects: &[ObjectState]) -> u64 {
    objects.iter().map(|object| object.moves).sum()
}

impl FingerState {
    /// Returns `true` if no feeler can make contact now that the links have moved from the joint positions `before`
    /// (rad or m). `moves` is the total number of motions of all objects. The fingertip's exact pose is then not
    /// needed.
    pub(crate) fn stays_free(&mut self, finger: &Finger, before: &JointVector, moves: u64) -> bool {
        let link = &self.joints.link;
        let moved = |joint: usize| finger.reach[joint] * (link[joint] - before[joint]).abs();
        let moved = match link.len() {
            3 => moved(0) + moved(1) + moved(2),
            count => (0..count).map(moved).sum(),
        };
        let watch = &mut self.watch;
        watch.unseen += moved;
        // `false` if the distance is NaN.
        watch.travelled + watch.unseen < watch.soonest
            && watch.moves == moves
            && self.held_at.is_none()
            && self.contacts.is_empty()
    }
}

/// Narrow-phase query of a free feeler: its clearance, the distance that it can travel without contact (m), and its
/// contact, if it touches.
fn look(
    finger: &Finger,
    sets: &[DVec3],
    objects: &[Object],
    seen: &[Pose],
    element: usize,
) -> (f64, Option<Contact>) {
    let feeler = finger.feeler(element);
    let (mut clearance, mut contact) = (f64::INFINITY, None);
    for (index, (object, seen)) in objects.iter().zip(seen).enumerate() {
        let tip = finger.undeformed(sets, seen, element);
        // At distance 0, up to rounding, the normal is undefined. The next step tries again.
        let Some(surface) = object.nearest(tip.at_rest()) else {
            return (0.0, None);
        };
        let depth = feeler.tip_radius - surface.distance;
        if -depth < clearance {
            clearance = -depth;
            contact = (depth > 0.0).then(|| Contact {
                element,
                object: index,
                anchor: feeler.anchor(&surface),
                rolled: 0.0,
                tip_before: tip.position,
            });
        }
    }
    if contact.is_some() {
        return (f64::INFINITY, contact);
    }
    // A feeler that recovers from creep also moves relative to the fingertip, at most by its whole set.
    (clearance - sets[element].length(), None)
}

/// Projects tips that have rolled along the tangent onto their surface.
fn put_back(model: &WorldModel, finger: &Finger, own: &mut FingerState) {
    for (index, object) in model.objects.iter().enumerate() {
        for (share, block) in own.contacts.on_mut(index).blocks_mut() {
            for lane in 0..share.count {
                if block.rolled[lane] <= FLAT {
                    continue;
                }
                if let Some(surface) = object.nearest(block.anchor(lane).position) {
                    let feeler = finger.feeler(block.element[lane]);
                    block.set_anchor(lane, &feeler.anchor(&surface));
                }
                block.rolled[lane] = 0.0;
            }
        }
    }
}
