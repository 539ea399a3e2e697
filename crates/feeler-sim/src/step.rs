//! One step of the physics: joints move, feelers touch, objects give way, feelers slip and relax.

use super::balance::balance;
use super::columnar_feeler::{Anchor, FeelerConfig, Friction, Overload, Tip, within_cone};
use super::free_bodies::FreeBodies;
use super::model::{Finger, WorldModel};
use super::object::{Motion, Object};
use super::pose::Pose;
use super::relaxation::relax;
use super::state::{Contact, FingerState, ObjectState, Slipped, State};
use feeler::hand::kinematics::fingertip_pose;
use glam::DVec3;

/// A tip that rolls may leave its surface along the tangent for this long, m: on a radius of 10 mm it
/// is then 0.2 nm off, and its normal 0.2 mrad.
const FLAT: f64 = 2e-6;

/// Advances `state` by one time step of `model`; `bodies` are its free bodies. Allocates nothing
/// but what the library of the free bodies does.
pub fn step(model: &WorldModel, state: &mut State, bodies: &mut FreeBodies) {
    for (finger, state) in model.fingers.iter().zip(&mut state.fingers) {
        move_finger(model, finger, state);
    }
    touch(model, state);
    for (index, object) in model.objects.iter().enumerate() {
        match &object.motion {
            Motion::Fixed => {
                settle(model, state, index, Overload::Steady, model.step);
                remember_tips(model, state, index);
            }
            Motion::Turns(hinge) => {
                balance(model, state, index, hinge);
                remember_tips(model, state, index);
            }
            Motion::Free(_) => {}
        }
    }
    if !bodies.is_empty() {
        move_bodies(model, state, bodies);
    }
    relax(model, state);
    state.filtered_torque +=
        model.torque_low_pass_gain * (state.torque_on_sensor(model) - state.filtered_torque);
    state.steps += 1;
    state.time = state.steps as f64 * model.step;
}

fn move_finger(model: &WorldModel, finger: &Finger, state: &mut FingerState) {
    let geometry = &finger.geometry;
    let limits = (geometry.joint_lower(), geometry.joint_upper());
    let remaining = model.servo_remaining_error;
    model
        .servo
        .advance(&mut state.joints, model.step, remaining, limits);
    state.tip = state.held_at.unwrap_or_else(|| {
        let (position, rotation) = fingertip_pose(geometry, state.joints.link);
        Pose { position, rotation }
    });
}

/// The undeformed feeler `element` of a `finger` whose fingertip is at `seen` in some frame, and whose
/// feelers have `sets`.
pub(super) fn undeformed(finger: &Finger, sets: &[DVec3], seen: &Pose, element: usize) -> Tip {
    let axis = seen.rotation * finger.normals[element];
    let relaxes = finger.feelers[element].relaxation.is_some();
    Tip {
        position: seen.position + finger.dome_radius * axis,
        axis,
        set: if relaxes {
            seen.rotation * sets[element]
        } else {
            DVec3::ZERO
        },
    }
}

/// Free feelers whose tips have come to a surface take hold of it; tips that have rolled are put back
/// on theirs.
fn touch(model: &WorldModel, state: &mut State) {
    for (finger, own) in model.fingers.iter().zip(&mut state.fingers) {
        let watch = &mut own.watch;
        let mut way = 0.0_f64;
        for (seen, object) in watch.seen.iter_mut().zip(&state.objects) {
            let now = own.tip.seen_from(&object.pose);
            way = way.max(now.motion_since(seen, finger.dome_radius));
            *seen = now;
        }
        watch.travelled += way;
        put_back(model, finger, &mut own.contacts);
        if own.contacts.is_empty() {
            for (rolled, seen) in own.rolled.iter_mut().zip(&watch.seen) {
                *rolled = seen.rotation;
            }
        }
        // Unless the way is not a number.
        if watch.soonest > watch.travelled {
            continue;
        }
        watch.soonest = f64::INFINITY;
        for element in 0..watch.due.len() {
            if watch.due[element] > watch.travelled {
                watch.soonest = watch.soonest.min(watch.due[element]);
                continue;
            }
            let (clearance, contact) =
                look(finger, &own.sets, &model.objects, &watch.seen, element);
            watch.due[element] = watch.travelled + clearance;
            watch.soonest = watch.soonest.min(watch.due[element]);
            own.contacts.extend(contact);
        }
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
    let feeler = &finger.feelers[element];
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

/// Friction of a feeler on an object as it is now.
pub(super) fn friction(
    finger: &Finger,
    object: &Object,
    state: &ObjectState,
    element: usize,
) -> Friction {
    let friction = object
        .friction
        .unwrap_or_else(|| finger.feelers[element].friction());
    friction.scaled(state.friction_factor)
}

/// Feelers on the object slip or let go, and their forces are known; how many slipped. `duration`
/// (s) is the time since their tips were remembered.
pub(super) fn settle(
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
        let seen = state.tip.seen_from(&own.pose);
        let turned = seen.turn_since(&state.rolled[index]);
        state.rolled[index] = seen.rotation;
        let FingerState {
            contacts,
            sets,
            forces,
            slipped,
            watch,
            ..
        } = state;
        contacts.retain_mut(|contact| {
            if contact.object != index {
                return true;
            }
            let feeler = &finger.feelers[contact.element];
            contact.anchor = feeler.rolled(&contact.anchor, turned);
            contact.rolled += feeler.tip_radius * turned.length();
            let tip = undeformed(finger, sets, &seen, contact.element);
            let mut friction = friction(finger, object, own, contact.element);
            let velocity = (tip.position - contact.tip_before) / duration;
            if friction.stribeck_speed > 0.0 {
                friction = friction.at_speed(velocity.reject_from(contact.anchor.normal).length());
            }
            let settled = feeler.settle(object, friction, &tip, contact.anchor, overload);
            let Some((anchor, mut force)) = settled else {
                slips += 1;
                forces[contact.element] = DVec3::ZERO;
                watch.due[contact.element] = watch.travelled;
                watch.soonest = watch.travelled;
                return false;
            };
            if anchor != contact.anchor {
                slips += 1;
                slipped[contact.element] += slip(feeler, &tip, &contact.anchor, &anchor);
                contact.anchor = anchor;
            }
            if feeler.is_damped() {
                force += feeler.damping_times(tip.axis, velocity);
                force = within_cone(force, anchor.normal, friction);
            }
            forces[contact.element] = own.pose.rotation * force;
            true
        });
    }
    slips
}

/// What a slip from one anchor to another takes. The feeler has no mass and its force falls in proportion,
/// so that friction takes the mean of both forces times the way: all that the spring loses.
fn slip(feeler: &FeelerConfig, tip: &Tip, from: &Anchor, to: &Anchor) -> Slipped {
    let way = to.position - from.position;
    let before = feeler.elastic_force(tip, from.position);
    let after = feeler.elastic_force(tip, to.position);
    Slipped {
        way: way.length(),
        work: 0.5 * (before + after).dot(way),
    }
}

/// Puts tips that have rolled along the tangent back on the surface.
fn put_back(model: &WorldModel, finger: &Finger, contacts: &mut [Contact]) {
    for contact in contacts.iter_mut().filter(|c| c.rolled > FLAT) {
        let object = &model.objects[contact.object];
        if let Some(surface) = object.nearest(contact.anchor.position) {
            contact.anchor = finger.feelers[contact.element].anchor(&surface);
        }
        contact.rolled = 0.0;
    }
}

/// Notes where the tips on an object are, for what depends on speed.
fn remember_tips(model: &WorldModel, state: &mut State, index: usize) {
    if !model.depends_on_speed {
        return;
    }
    let pose = &state.objects[index].pose;
    for (finger, state) in model.fingers.iter().zip(&mut state.fingers) {
        let seen = state.tip.seen_from(pose);
        for contact in state.contacts.iter_mut().filter(|c| c.object == index) {
            contact.tip_before = undeformed(finger, &state.sets, &seen, contact.element).position;
        }
    }
}

/// Moves the free bodies over one step, in as many parts as their contacts' stiffness asks for.
fn move_bodies(model: &WorldModel, state: &mut State, bodies: &mut FreeBodies) {
    bodies.weigh(&state.objects);
    let parts = bodies.parts(model, state);
    let duration = model.step / parts as f64;
    for part in 0..parts {
        // The fingers move in the first part.
        let since = if part == 0 { model.step } else { duration };
        for (index, object) in model.objects.iter().enumerate() {
            if matches!(object.motion, Motion::Free(_)) {
                settle(model, state, index, Overload::Steady, since);
                remember_tips(model, state, index);
                let (force, torque) = wrench(model, state, index);
                let (outside_force, outside_torque) = state.objects[index].outside;
                bodies.push(index, force + outside_force, torque + outside_torque);
            }
        }
        bodies.advance(duration);
        bodies.read(&mut state.objects);
    }
}

/// Force, N, and torque about its origin, N·m, on an object by the feelers, in W.
pub fn wrench(model: &WorldModel, state: &State, index: usize) -> (DVec3, DVec3) {
    let pose = &state.objects[index].pose;
    let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
    for (finger, state) in model.fingers.iter().zip(&state.fingers) {
        for contact in state.contacts.iter().filter(|c| c.object == index) {
            let point = finger.feelers[contact.element].contact_point(&contact.anchor);
            let pushed = state.forces[contact.element];
            force += pushed;
            torque += (pose.rotation * point).cross(pushed);
        }
    }
    (force, torque)
}
