//! Checks of a world: no overlaps at the start, and finite values in each step.

use super::model::WorldModel;
use super::state::State;
use crate::error::SimError;
use crate::objects::free_bodies::collider;
use crate::objects::object::{Motion, Object};
use glam::{DQuat, DVec3};
use parry3d_f64::math::Pose as LibraryPose;
use parry3d_f64::query::contact;

/// Tolerated penetration of bodies that rest on or just touch each other (m).
const TOLERANCE: f64 = 1e-5;

/// Checks that at the start no feeler is inside an object, and no free body inside another object.
///
/// # Errors
/// [`SimError::StartsInside`] or [`SimError::Overlap`] for the first such pair.
pub fn check(model: &WorldModel, state: &State) -> Result<(), SimError> {
    check_feelers(model, state)?;
    for (index, object) in model.objects.iter().enumerate() {
        for other in &model.objects[index + 1..] {
            let free = [object, other].map(|o| matches!(o.motion, Motion::Free(_)));
            if free == [false, false] {
                continue;
            }
            // parry's query is correct for a half-space only if it is the first shape.
            let depth = if is_half_space(other) {
                overlap(other, object)
            } else {
                overlap(object, other)
            };
            if depth > TOLERANCE {
                return Err(SimError::Overlap {
                    object: object.name.clone(),
                    other: other.name.clone(),
                    depth,
                });
            }
        }
    }
    Ok(())
}

fn is_half_space(object: &Object) -> bool {
    object.shape.collider().0.as_halfspace().is_some()
}

/// Penetration depth of two objects at the start (m); 0 if they are apart.
fn overlap(object: &Object, other: &Object) -> f64 {
    let place = |object: &Object| {
        let rotation = DQuat::from_mat3(&object.start.rotation);
        let (shape, within) = collider(object);
        let offset = LibraryPose::from_translation(object.offset);
        let pose = LibraryPose::from_parts(object.start.position, rotation);
        (shape, pose * offset * within)
    };
    let ((one, at), (two, there)) = (place(object), place(other));
    let found = contact(&at, &*one, &there, &*two, 0.0).ok().flatten();
    found.map_or(0.0, |contact| -contact.dist)
}

fn check_feelers(model: &WorldModel, state: &State) -> Result<(), SimError> {
    for (number, (finger, own)) in model.fingers.iter().zip(&state.fingers).enumerate() {
        for (object, now) in model.objects.iter().zip(&state.objects) {
            let seen = own.tip.relative_to(&now.pose);
            for (element, feeler) in finger.feelers.iter().enumerate() {
                let tip = finger.undeformed(&own.sets, &seen, element).position;
                let distance = object.nearest(tip).map_or(0.0, |s| s.distance);
                let depth = feeler.tip_radius - distance;
                if depth > TOLERANCE {
                    return Err(SimError::StartsInside {
                        object: object.name.clone(),
                        finger: number,
                        element,
                        depth,
                    });
                }
            }
        }
    }
    Ok(())
}

impl State {
    /// Checks that all quantities are finite.
    ///
    /// # Errors
    /// [`SimError::NotFinite`] for the first quantity that is not.
    pub fn check_finite(&self, model: &WorldModel) -> Result<(), SimError> {
        let fingers = self.fingers.iter().map(|finger| {
            let contacts = finger.contacts.iter();
            let forces: DVec3 = contacts.map(|c| finger.forces[c.element]).sum();
            finger.tip.position + forces
        });
        let objects = self.objects.iter().map(|o| o.pose.position + o.velocity);
        let turns = self.objects.iter().map(|o| o.turn.angle + o.turn.torque);
        if fingers.chain(objects).all(DVec3::is_finite) && turns.fold(0.0, |a, b| a + b).is_finite()
        {
            return Ok(());
        }
        Err(self.not_finite(model))
    }

    /// Returns the error about the first quantity that is not finite.
    #[cold]
    fn not_finite(&self, model: &WorldModel) -> SimError {
        for (number, finger) in self.fingers.iter().enumerate() {
            let joints = finger.joints.position;
            if !joints.is_finite() {
                return SimError::NotFinite {
                    step: self.steps,
                    quantity: format!("the joint angles of finger {number}"),
                    value: joints.to_string(),
                };
            }
        }
        let mut quantities: Vec<(String, DVec3)> = Vec::new();
        for (number, finger) in self.fingers.iter().enumerate() {
            let position = finger.tip.position;
            quantities.push((format!("the position of fingertip {number}"), position));
            for (element, &force) in finger.forces.iter().enumerate() {
                let name = format!("the force of element {element} of finger {number}");
                quantities.push((name, force));
            }
        }
        for (object, own) in self.objects.iter().zip(&model.objects) {
            let name = &own.name;
            quantities.push((format!("the position of {name}"), object.pose.position));
            quantities.push((format!("the velocity of {name}"), object.velocity));
            let turn = DVec3::new(object.turn.angle, object.turn.torque, 0.0);
            quantities.push((format!("angle and torque of {name}"), turn));
        }
        let found = quantities.into_iter().find(|(_, value)| !value.is_finite());
        let (quantity, value) = found.unwrap_or_else(|| ("a sum".to_string(), DVec3::NAN));
        SimError::NotFinite {
            step: self.steps,
            quantity,
            value: value.to_string(),
        }
    }
}
