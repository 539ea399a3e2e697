//! One step of the physics: joints move, feelers touch, the cap gives way, feelers slip.

use super::cap::{CapPose, Grip};
use super::feeler::{Anchor, FeelerConfig, Tip};
use super::model::Model;
use super::object::Object;
use super::state::{FingerState, State};
use crate::hand::kinematics::fingertip_pose;
use glam::{DMat3, DVec3};

/// A slip lowers the torque on the cap, so the first or second round finds nothing more to do; the
/// bound keeps a step's time finite.
const MAX_BALANCE_ROUNDS: usize = 8;

/// Advances `state` by one time step of `model`. Allocates nothing.
pub fn step(model: &Model, state: &mut State) {
    for (geometry, finger) in model.fingers.iter().zip(&mut state.fingers) {
        let limits = (geometry.joint_lower(), geometry.joint_upper());
        let remaining = model.servo_remaining_error;
        model
            .servo
            .advance(&mut finger.joints, model.step, remaining, limits);
        (finger.position, finger.rotation) = fingertip_pose(geometry, finger.joints.position);
        touch(model, &state.cap_pose, finger);
    }
    balance(model, state);
    state.filtered_torque +=
        model.torque_low_pass_gain * (state.cap.torque - state.filtered_torque);
    state.steps += 1;
    state.time = state.steps as f64 * model.step;
}

/// A fingertip as seen from the cap.
struct FingertipInCap {
    position: DVec3,
    rotation: DMat3,
    dome_radius: f64,
}

impl FingertipInCap {
    fn new(model: &Model, cap: &CapPose, finger: &FingerState) -> Self {
        let to_cap = cap.rotation.transpose();
        Self {
            position: to_cap * (finger.position - cap.centre),
            rotation: to_cap * finger.rotation,
            dome_radius: model.layout.dome_radius,
        }
    }

    /// The undeformed feeler along `normal` (in `T`).
    fn tip(&self, normal: DVec3) -> Tip {
        let axis = self.rotation * normal;
        Tip {
            position: self.position + self.dome_radius * axis,
            axis,
        }
    }
}

/// Free feelers whose tips have come to the cap's surface take hold of it.
fn touch(model: &Model, cap: &CapPose, finger: &mut FingerState) {
    let fingertip = FingertipInCap::new(model, cap, finger);
    let reach = model.layout.dome_radius + model.feeler.tip_radius;
    if !model.object.is_near(fingertip.position, reach) {
        return;
    }
    for (anchor, &normal) in finger.anchors.iter_mut().zip(&model.normals) {
        if anchor.is_none() {
            *anchor = model.feeler.touch(&model.object, &fingertip.tip(normal));
        }
    }
}

/// Turns the cap and lets feelers slip until the torques on the cap balance and nothing slips.
fn balance(model: &Model, state: &mut State) {
    for round in 0..MAX_BALANCE_ROUNDS {
        turn_cap(model, state);
        let cap = &state.cap_pose;
        // The motion of this step overloads feelers steadily, and first; then one feeler's slip
        // overloads another at a stroke.
        let settle_one = if round == 0 {
            FeelerConfig::settle_driven
        } else {
            FeelerConfig::settle
        };
        let fingers = state.fingers.iter_mut();
        let slips = fingers.map(|finger| settle(model, cap, finger, settle_one));
        if slips.sum::<usize>() == 0 {
            break;
        }
    }
}

/// Turns the cap until the torques on it balance, feelers holding on as firmly as they can.
fn turn_cap(model: &Model, state: &mut State) {
    let State { fingers, cap, .. } = state;
    model.cap.turn(cap, model.torque_sensor.stiffness, |cap| {
        let pose = model.cap.pose(cap, model.cap_start_angle);
        fingers.iter().fold(Grip::default(), |sum, finger| {
            let grip = finger_grip(model, &pose, finger);
            Grip {
                torque: sum.torque + grip.torque,
                stiffness: sum.stiffness + grip.stiffness,
            }
        })
    });
    state.cap_pose = model.cap.pose(&state.cap, model.cap_start_angle);
}

/// What one finger's feelers do to a cap in `pose`.
fn finger_grip(model: &Model, pose: &CapPose, finger: &FingerState) -> Grip {
    let fingertip = FingertipInCap::new(model, pose, finger);
    let mut grip = Grip::default();
    for (anchor, &normal) in finger.anchors.iter().zip(&model.normals) {
        let Some(anchor) = anchor else { continue };
        let tip = fingertip.tip(normal);
        let force = model.feeler.holding_force(&tip, anchor);
        let contact = anchor.position - model.feeler.tip_radius * anchor.normal;
        // Velocity of the contact point per rate of turn: z x contact.
        let lever = DVec3::new(-contact.y, contact.x, 0.0);
        grip.torque += lever.dot(force);
        grip.stiffness += lever.dot(model.feeler.stiffness_times(tip.axis, lever));
    }
    grip
}

/// Lets one feeler slip or let go.
type SettleOne = fn(&FeelerConfig, &Object, &Tip, Anchor) -> Option<(Anchor, DVec3)>;

/// Feelers slip or let go, and their forces are known; how many slipped.
fn settle(model: &Model, cap: &CapPose, finger: &mut FingerState, settle_one: SettleOne) -> usize {
    let mut slips = 0;
    let fingertip = FingertipInCap::new(model, cap, finger);
    for ((anchor, force), &normal) in finger
        .anchors
        .iter_mut()
        .zip(&mut finger.forces)
        .zip(&model.normals)
    {
        let Some(held) = *anchor else { continue };
        let tip = fingertip.tip(normal);
        let settled = settle_one(&model.feeler, &model.object, &tip, held);
        *anchor = settled.map(|(anchor, _)| anchor);
        *force = settled.map_or(DVec3::ZERO, |(_, force)| cap.rotation * force);
        slips += usize::from(*anchor != Some(held));
    }
    slips
}
