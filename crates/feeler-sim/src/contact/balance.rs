//! Quasi-static balance of an object on a thread or hinge, and of the bottle under it in its holder.

use super::columnar_feeler::Overload;
use super::grip::{Freedom, grip};
use super::settle::settle;
use crate::objects::holder::PlaySpring;
use crate::objects::thread::{FingerLoad, Hinge};
use crate::world::model::WorldModel;
use crate::world::state::{FingerState, State};
use multiversion::multiversion;
use std::f64::consts::TAU;

/// Maximum number of iterations that balance the torques and let feelers slip. A slip reduces the torque on the object,
/// so one or two iterations usually suffice; the maximum limits the duration of a step.
const MAX_BALANCE_ROUNDS: usize = 8;

/// Maximum number of iterations that shift and turn the object. Each affects the balance of the other only slightly.
const MAX_GIVING_ROUNDS: usize = 8;

/// Maximum number of Newton steps of a shift along both axes.
const MAX_SHIFT_ITERATIONS: usize = 16;

/// Shift below which a bottle is in balance (m). It corresponds to a force of 0.1 uN on the feelers of a fingertip.
const SHIFT_TOLERANCE: f64 = 1e-11;

/// Turns an object, alternating with slips of feelers, until torques balance and nothing slips.
pub(crate) fn balance(model: &WorldModel, state: &mut State, object: usize, hinge: &Hinge) {
    let before = state.objects[object].turn;
    let mut fingers = state.fingers.iter();
    if before.is_unloaded() && !fingers.any(|finger| finger.touches(object)) {
        state.objects[object].last_turn = (0.0, 0.0);
        return;
    }
    // Initial guess for the first round only, as further turning due to slips cannot be predicted.
    let mut ahead = state.objects[object].last_turn;
    for round in 0..MAX_BALANCE_ROUNDS {
        match &model.sides {
            Some(sides) if hinge.on_torque_sensor => {
                shift_and_turn(model, state, object, hinge, sides)
            }
            _ => turn(model, state, object, hinge, std::mem::take(&mut ahead)),
        }
        // In the first round, feelers are overloaded steadily by the step's motion; in later rounds, instantaneously by
        // slips of other feelers.
        let overload = if round == 0 {
            Overload::Steady
        } else {
            Overload::Sudden
        };
        if settle(model, state, object, overload, model.step) == 0 {
            break;
        }
    }
    let own = &mut state.objects[object];
    own.last_turn = (own.turn.angle - before.angle, own.turn.twist - before.twist);
}

/// Shifts and turns an object until both the forces and the torque on it balance.
///
/// Forces are balanced before each turn, to avoid overshoot: a later shift could reduce the torque, and the thread
/// would hold the object at the larger angle.
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
        turn(model, state, object, hinge, (0.0, 0.0));
        turned |= state.objects[object].turn.turning;
    }
    state.objects[object].turn.turning = turned;
}

/// Shifts the support of an object until the forces along W's x and y balance. Returns `true` if it moved.
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
            let seen = |finger: &FingerState| finger.tip.relative_to(&pose);
            let grip = grip(model, fingers, own, index, seen, Freedom::Along(along));
            let to = side.give(turn.shift[axis], grip.load, grip.firm);
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
    for finger in fingers {
        finger.seen[index] = finger.tip.relative_to(&own.pose);
    }
    way > SHIFT_TOLERANCE
}

/// Turns an object until the torques on it balance; feelers stick up to their static limit.
#[multiversion(targets("x86_64+avx2"))]
fn turn(model: &WorldModel, state: &mut State, index: usize, hinge: &Hinge, ahead: (f64, f64)) {
    let State {
        fingers, objects, ..
    } = state;
    let (object, own) = (&model.objects[index], &mut objects[index]);
    let touched = fingers.iter().any(|finger| finger.touches(index));
    let mut turn = own.turn;
    hinge.turn(&mut turn, ahead, &model.shaft, |turn| {
        if !touched {
            return FingerLoad::default();
        }
        let screw = hinge.screw(&own.turn, turn);
        let seen = |finger: &FingerState| screw.seen_after(&finger.seen[index]);
        // The support twists without descending.
        let sinking = if turn.turning {
            hinge.thread.lead / TAU
        } else {
            0.0
        };
        grip(model, fingers, own, index, seen, Freedom::Around(sinking))
    });
    if turn != own.turn {
        own.turn = turn;
        own.move_to(hinge.pose(&turn, &object.start));
    }
}
