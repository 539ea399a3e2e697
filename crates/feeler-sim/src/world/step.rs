//! One physics step: joints move, feelers make contact, objects yield, feelers slip and relax.

use super::model::{Finger, WorldModel};
use super::state::{FingerState, State};
use crate::contact::balance::balance;
use crate::contact::columnar_feeler::Overload;
use crate::contact::detection::{moves, touch};
use crate::contact::settle::{remember_tips, settle};
use crate::objects::free_bodies::FreeBodies;
use crate::objects::object::Motion;
use crate::objects::pose::Pose;
use crate::rig::arm::{acceleration, displacement};
use feeler::hand::kinematics::fingertip_pose;
use glam::DVec3;
use multiversion::multiversion;

/// Advances `state` by one time step of `model`; `bodies` are its free bodies. Allocates only within `rapier3d`.
///
/// If `is_seen` is `false`, poses of fingertips that cannot make contact are not updated. Later steps give the same
/// result in either case.
pub(crate) fn step(
    model: &WorldModel,
    state: &mut State,
    bodies: Option<&mut FreeBodies>,
    is_seen: bool,
) {
    let State {
        fingers, objects, ..
    } = state;
    let moves = moves(objects);
    // One loop per stage, because fingers are independent of each other within a stage.
    for (finger, own) in model.fingers.iter().zip(&mut *fingers) {
        let before = own.joints.link;
        move_joints(model, finger, own);
        own.is_left = own.stays_free(finger, &before, moves) && !is_seen && bodies.is_none();
    }
    place_fingertips(model, fingers);
    for (finger, own) in model.fingers.iter().zip(fingers) {
        if !own.is_left {
            touch(model, finger, own, objects);
        }
    }
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
    if let Some(bodies) = bodies {
        move_bodies(model, state, bodies);
    }
    relax(model, state);
    state.filtered_torque +=
        model.torque_low_pass_gain * (state.torque_on_sensor(model) - state.filtered_torque);
    state.steps += 1;
    state.time = state.steps as f64 * model.step;
}

fn move_joints(model: &WorldModel, finger: &Finger, state: &mut FingerState) {
    let geometry = &finger.geometry;
    let limits = (geometry.joint_lower(), geometry.joint_upper());
    let remaining = model.servo_remaining_error;
    model
        .servo
        .advance(&mut state.joints, model.step, remaining, limits);
}

#[multiversion(targets("x86_64+avx2"))]
fn place_fingertips(model: &WorldModel, fingers: &mut [FingerState]) {
    for (finger, own) in model.fingers.iter().zip(fingers) {
        if own.is_left {
            continue;
        }
        own.tip = own.held_at.unwrap_or_else(|| {
            let (position, rotation) = fingertip_pose(&finger.geometry, own.joints.link);
            Pose { position, rotation }
        });
    }
}

/// Moves the free bodies over one step, in substeps that the stiffness of their contacts requires.
fn move_bodies(model: &WorldModel, state: &mut State, bodies: &mut FreeBodies) {
    bodies.weigh(&state.objects);
    let parts = bodies.parts(model, state);
    let duration = model.step / parts as f64;
    for part in 0..parts {
        // The fingers move in the first substep.
        let since = if part == 0 { model.step } else { duration };
        for (index, object) in model.objects.iter().enumerate() {
            if matches!(object.motion, Motion::Free(_)) {
                settle(model, state, index, Overload::Steady, since);
                remember_tips(model, state, index);
                let (force, torque) = wrench(model, state, index);
                let own = &state.objects[index];
                let (outside_force, outside_torque) = own.outside;
                let force = force + outside_force + own.pull;
                bodies.push(index, force, torque + outside_torque);
            }
        }
        if !model.arm.is_empty() {
            let time = state.time + f64::from(part as u32 + 1) * duration;
            pass(model, state, time);
            bodies.carry(
                &state.objects,
                model.gravity - acceleration(&model.arm, time),
            );
        }
        bodies.advance(duration);
        bodies.read(&mut state.objects);
    }
}

/// Moves the fixed objects to their poses relative to the hand at `time` (s), as the arm moves the hand.
fn pass(model: &WorldModel, state: &mut State, time: f64) {
    let passed = displacement(&model.arm, time);
    for (object, own) in model.objects.iter().zip(&mut state.objects) {
        if matches!(object.motion, Motion::Fixed) {
            let position = object.start.position - passed;
            own.move_to(Pose {
                position,
                ..object.start
            });
        }
    }
}

/// Force (N) of the feelers on an object, and torque (N·m) about its origin, in W.
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

/// Relaxes all feelers over one step, at the deformation at its end.
///
/// A feeler's *set* (creep displacement) is constant within a step, so it lags a changing deformation by half a step:
/// a relative error of `step / (2 time)` of the energy dissipated per load cycle. In exchange, the stiffness within a
/// step does not depend on the step's length.
fn relax(model: &WorldModel, state: &mut State) {
    if !model.relaxes {
        return;
    }
    let State {
        fingers, objects, ..
    } = state;
    for (finger, own) in model.fingers.iter().zip(fingers) {
        let to_fingertip = own.tip.rotation.transpose();
        for (element, set) in own.sets.iter_mut().enumerate() {
            let Some(relaxation) = &finger.feelers[element].relaxation else {
                continue;
            };
            let mut touching = own.contacts.iter();
            *set = match touching.find(|contact| contact.element == element) {
                Some(contact) => {
                    let anchor = objects[contact.object]
                        .pose
                        .to_world(contact.anchor.position);
                    let anchor = to_fingertip * (anchor - own.tip.position);
                    let displacement = finger.dome_radius * finger.normals[element] - anchor;
                    relaxation.held(*set, displacement, model.step)
                }
                None => relaxation.recovered(*set, model.step),
            };
        }
    }
}
