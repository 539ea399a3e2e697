//! Free feelers on the way to a surface, and those that take hold of it.

use super::model::{Finger, WorldModel};
use super::object::Object;
use super::pose::Pose;
use super::state::{Contact, FingerState, GROUP, ObjectState};
use super::step::undeformed;
use glam::DVec3;

/// A tip that rolls may leave its surface along the tangent for this long, m: on a radius of 10 mm it
/// is then 0.2 nm off, and its normal 0.2 mrad.
const FLAT: f64 = 2e-6;

/// Free feelers of a finger whose tips have come to a surface take hold of it; tips that have rolled are put back
/// on theirs.
pub(super) fn touch(
    model: &WorldModel,
    finger: &Finger,
    own: &mut FingerState,
    objects: &[ObjectState],
) {
    let watch = &mut own.watch;
    let mut way = 0.0_f64;
    let seen = watch.seen.iter_mut().zip(&mut own.seen);
    for ((before, seen), object) in seen.zip(objects) {
        *seen = own.tip.seen_from(&object.pose);
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
        // Mostly none of them is.
        if group
            .iter()
            .fold(false, |any, &due| any | (due <= travelled))
        {
            // The last group's unused places have no element; they are never due, unless the travel diverges to infinity.
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

/// How often objects have moved by now, all together.
pub(super) fn moves(objects: &[ObjectState]) -> u64 {
    objects.iter().map(|object| object.moves).sum()
}

impl FingerState {
    /// Whether no feeler touches or can touch anything after the joints have turned by `turn` (rad) once more, objects having moved
    /// `moves` times by now. Then it does not matter where exactly the fingertip is.
    pub(super) fn stays_free(&mut self, finger: &Finger, turn: DVec3, moves: u64) -> bool {
        let watch = &mut self.watch;
        watch.unseen += finger.reach.dot(turn.abs());
        // Not where the way is not a number.
        watch.travelled + watch.unseen < watch.soonest
            && watch.moves == moves
            && self.held_at.is_none()
            && self.contacts.is_empty()
    }
}

/// How far a free feeler may come before it can touch anything, m, and the hold that it takes if it does.
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
        let tip = undeformed(finger, sets, seen, element);
        // On the surface to within rounding, so that the direction to it tells nothing: the next
        // step will see.
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
    // A feeler that recovers from its set moves by itself, by all of it at most.
    (clearance - sets[element].length(), None)
}

/// Puts tips that have rolled along the tangent back on the surface.
fn put_back(model: &WorldModel, finger: &Finger, own: &mut FingerState) {
    for (index, object) in model.objects.iter().enumerate() {
        for (share, block) in own.contacts.on_mut(index).blocks_mut() {
            for lane in 0..share.count {
                if block.rolled(lane) <= FLAT {
                    continue;
                }
                if let Some(surface) = object.nearest(block.anchor(lane).position) {
                    let feeler = finger.feeler(block.element(lane));
                    block.set_anchor(lane, &feeler.anchor(&surface));
                }
                block.set_rolled(lane, 0.0);
            }
        }
    }
}
