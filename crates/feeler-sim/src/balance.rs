//! What turns gives way: an object on a thread or hinge, and the bottle under it in its holder.

use super::columnar_feeler::{Anchor, FeelerConfig, Friction, Overload, Tip, tip_of, within_cone};
use super::contacts::{BLOCK, Column};
use super::holder::PlaySpring;
use super::model::WorldModel;
use super::pose::Pose;
use super::settle::{friction, settle};
use super::state::{FingerState, ObjectState, State};
use super::step::undeformed;
use super::thread::{FingerLoad, Hinge};
use glam::DVec3;
use multiversion::multiversion;

/// A slip lowers the torque on what turns, so the first or second round finds nothing more to do;
/// the bound keeps a step's time finite.
const MAX_BALANCE_ROUNDS: usize = 8;

/// Turning and shifting by turns; each changes little of what the other has balanced.
const MAX_GIVING_ROUNDS: usize = 8;

/// Newton steps of a shift along both axes.
const MAX_SHIFT_ITERATIONS: usize = 16;

/// A bottle stands still when it shifts by less, m: on the feelers of a fingertip, 0.1 uN.
const SHIFT_TOLERANCE: f64 = 1e-11;

/// Turns an object and lets feelers slip until the torques on it balance and nothing slips.
pub(super) fn balance(model: &WorldModel, state: &mut State, object: usize, hinge: &Hinge) {
    for round in 0..MAX_BALANCE_ROUNDS {
        match &model.sides {
            Some(sides) if hinge.on_torque_sensor => {
                shift_and_turn(model, state, object, hinge, sides)
            }
            _ => turn(model, state, object, hinge),
        }
        // The motion of this step overloads feelers steadily, and first; then one feeler's slip
        // overloads another at a stroke.
        let overload = if round == 0 {
            Overload::Steady
        } else {
            Overload::Sudden
        };
        if settle(model, state, object, overload, model.step) == 0 {
            break;
        }
    }
}

/// Shifts and turns an object until both forces and torques on it balance.
///
/// The shift is balanced whenever the object turns. Then it never turns too far, as it would where a shift
/// takes torque off it: the thread would hold it there.
fn shift_and_turn(
    model: &WorldModel,
    state: &mut State,
    object: usize,
    hinge: &Hinge,
    sides: &[PlaySpring; 2],
) {
    let mut turned = false;
    for round in 0..MAX_GIVING_ROUNDS {
        let shifted = shift(model, state, object, hinge, sides);
        if round > 0 && !shifted {
            break;
        }
        turn(model, state, object, hinge);
        turned |= state.objects[object].turn.turning;
    }
    state.objects[object].turn.turning = turned;
}

/// Shifts what an object stands on until the forces along W's x and y balance; whether it had to.
#[multiversion(targets("x86_64+avx2"))]
fn shift(
    model: &WorldModel,
    state: &mut State,
    index: usize,
    hinge: &Hinge,
    sides: &[PlaySpring; 2],
) -> bool {
    let State {
        fingers, objects, ..
    } = state;
    let (object, own) = (&model.objects[index], &mut objects[index]);
    let mut turn = own.turn;
    for _ in 0..MAX_SHIFT_ITERATIONS {
        let mut moved = 0.0_f64;
        for (axis, side) in sides.iter().enumerate() {
            let pose = hinge.pose(&turn, &object.start);
            let along = pose.rotation.row(axis);
            let grip = grip(model, fingers, own, index, &pose, |_| along);
            let to = side.give(turn.shift[axis], &grip);
            moved = moved.max((to - turn.shift[axis]).abs());
            turn.shift[axis] = to;
        }
        if moved <= SHIFT_TOLERANCE {
            break;
        }
    }
    let way = turn.shift.distance(own.turn.shift);
    own.turn = turn;
    own.move_to(hinge.pose(&turn, &object.start));
    way > SHIFT_TOLERANCE
}

/// Turns an object until the torques on it balance, feelers holding on as firmly as they can.
#[multiversion(targets("x86_64+avx2"))]
fn turn(model: &WorldModel, state: &mut State, index: usize, hinge: &Hinge) {
    let State {
        fingers, objects, ..
    } = state;
    let (object, own) = (&model.objects[index], &mut objects[index]);
    let touches = |finger: &FingerState| !finger.contacts.on(index).is_empty();
    let touched = fingers.iter().any(touches);
    let mut turn = own.turn;
    hinge.turn(&mut turn, &model.shaft, |turn| {
        if !touched {
            return FingerLoad::default();
        }
        let pose = hinge.pose(turn, &object.start);
        // z x point
        let around = |point: DVec3| DVec3::new(-point.y, point.x, 0.0);
        grip(model, fingers, own, index, &pose, around)
    });
    if turn != own.turn {
        own.turn = turn;
        own.move_to(hinge.pose(&turn, &object.start));
    }
}

/// What the feelers on an object would do at `pose` along one of its freedoms, holding on: `way` is the
/// velocity of a point of the object per rate of that freedom, in the object's frame.
#[inline(always)]
fn grip(
    model: &WorldModel,
    fingers: &[FingerState],
    own: &ObjectState,
    index: usize,
    pose: &Pose,
    way: impl Fn(DVec3) -> DVec3,
) -> FingerLoad {
    let object = &model.objects[index];
    let mut sum = FingerLoad::default();
    for (finger, state) in model.fingers.iter().zip(fingers) {
        let contacts = state.contacts.on(index);
        if contacts.is_empty() {
            continue;
        }
        let seen = state.tip.seen_from(pose);
        let turned = seen.turn_since(&state.rolled[index]);
        for (share, block) in contacts.blocks() {
            let (mut load, mut stiffness): (Column, Column) = ([0.0; BLOCK], [0.0; BLOCK]);
            if let Some(spring) = &finger.springs {
                let spring = spring.as_spring();
                let friction = friction(&spring, object, own);
                for lane in 0..share.lanes.min(BLOCK) {
                    let anchor = spring.rolled(&block.anchor(lane), turned);
                    let axis = block.axis(lane);
                    let tip = tip_of(finger.dome_radius, &seen, axis, DVec3::ZERO);
                    let still = (DVec3::ZERO, model.step);
                    let grip = contact_grip(&spring, friction, &tip, &anchor, still, &way);
                    (load[lane], stiffness[lane]) = (grip.load, grip.stiffness);
                }
            } else {
                for lane in 0..share.count {
                    let element = block.element(lane);
                    let feeler = &finger.feelers[element];
                    let anchor = feeler.rolled(&block.anchor(lane), turned);
                    let tip = undeformed(finger, &state.sets, &seen, element);
                    let moved = (tip.position - block.tip_before(lane), model.step);
                    let friction = friction(feeler, object, own);
                    let grip = contact_grip(feeler, friction, &tip, &anchor, moved, &way);
                    (load[lane], stiffness[lane]) = (grip.load, grip.stiffness);
                }
            }
            for (load, stiffness) in load.iter().zip(&stiffness).take(share.count) {
                sum.load += load;
                sum.stiffness += stiffness;
            }
        }
    }
    sum
}

/// What one feeler does to an object along one of its freedoms, holding on. `moved` is by how much its tip has moved, m, and in which
/// time, s.
#[inline(always)]
fn contact_grip(
    feeler: &FeelerConfig,
    friction: Friction,
    tip: &Tip,
    anchor: &Anchor,
    (moved, duration): (DVec3, f64),
    way: impl Fn(DVec3) -> DVec3,
) -> FingerLoad {
    let mut force = feeler.holding_force(friction, tip, anchor);
    let way = way(feeler.contact_point(anchor));
    let mut stiffness = way.dot(feeler.stiffness_times(tip.axis, way));
    if feeler.is_damped() {
        let velocity = moved / duration;
        force += feeler.damping_times(tip.axis, velocity);
        force = within_cone(force, anchor.normal, friction);
        stiffness += way.dot(feeler.damping_times(tip.axis, way)) / duration;
    }
    FingerLoad {
        load: way.dot(force),
        stiffness,
    }
}
