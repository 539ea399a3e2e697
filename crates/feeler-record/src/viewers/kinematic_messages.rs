//! Messages of a hand's kinematics: robot description, joint states and transforms.

use super::urdf::urdf;
use crate::error::RecordError;
use crate::messages::facts::RunFacts;
use crate::messages::model::{Frame, joint_names};
use crate::ros::{Header, JointState, TFMessage, Text, Time, TransformStamped};
use feeler::hand::{FingerGeometry, JointVector};

/// Robot description, joint states and transforms of a hand. Their memory is reused.
pub struct KinematicMessages {
    /// URDF of the hand and the solids around it.
    pub description: Text,
    /// Transforms of fixed frames.
    pub still: TFMessage,
    /// Transforms of frames that move with a joint.
    pub moving: TFMessage,
    /// Joint angles and velocities.
    pub joints: JointState,
    /// Frames of `moving`, each with the index of its finger.
    frames: Vec<(usize, Frame)>,
    /// Geometry of each finger.
    geometries: Vec<FingerGeometry>,
}

impl KinematicMessages {
    /// Creates the messages of the hand described by `facts`.
    ///
    /// # Errors
    /// If `facts` are invalid.
    pub fn new(facts: &RunFacts) -> Result<Self, RecordError> {
        let mut messages = Self {
            description: Text {
                data: urdf(&facts.experiment, &facts.hand, &facts.solids)?,
                stamp: 0.0,
            },
            still: TFMessage::default(),
            moving: TFMessage::default(),
            joints: JointState::default(),
            frames: Vec::new(),
            geometries: Vec::new(),
        };
        for (finger, model) in facts.hand.iter().enumerate() {
            let geometry = model.geometry()?;
            let names = joint_names(finger, geometry.frame_count());
            messages.joints.name.extend(names);
            messages.geometries.push(geometry);
            for frame in model.frames(finger)? {
                let place = transform(&frame);
                if frame.moving.is_none() {
                    messages.still.transforms.push(place);
                } else {
                    messages.moving.transforms.push(place);
                    messages.frames.push((finger, frame));
                }
            }
        }
        Ok(messages)
    }

    /// Sets the joint positions (rad or m) and velocities of the fingers, in order.
    pub fn set_joints(
        &mut self,
        stamp: Time,
        joints: impl Iterator<Item = (JointVector, JointVector)>,
    ) {
        self.joints.header.stamp = stamp;
        self.joints.position.clear();
        self.joints.velocity.clear();
        for (geometry, (position, velocity)) in self.geometries.iter().zip(joints) {
            self.joints
                .position
                .extend(geometry.frame_positions(position));
            self.joints
                .velocity
                .extend(geometry.frame_velocities(velocity));
        }
    }

    /// Sets the transforms of moving frames. `joints` returns the joint positions of a finger (rad or m), or `None` to
    /// keep its transforms.
    pub fn set_moving(&mut self, stamp: Time, joints: impl Fn(usize) -> Option<JointVector>) {
        for ((finger, frame), place) in self.frames.iter().zip(&mut self.moving.transforms) {
            let (Some(joints), Some(geometry)) = (joints(*finger), self.geometries.get(*finger))
            else {
                continue;
            };
            let index = frame.moving.unwrap_or_default();
            let position = geometry
                .frame_positions(joints)
                .nth(index)
                .unwrap_or_default();
            place.header.stamp = stamp;
            place.transform = frame.in_parent(position).into();
        }
    }

    /// Sets the stamp of the fixed transforms.
    pub fn set_still(&mut self, stamp: Time) {
        for place in &mut self.still.transforms {
            place.header.stamp = stamp;
        }
    }
}

/// Returns the transform of `frame` to its parent at position 0.
fn transform(frame: &Frame) -> TransformStamped {
    TransformStamped {
        header: Header::of(frame.parent.as_str()),
        child_frame_id: frame.name.clone(),
        transform: frame.in_parent(0.0).into(),
    }
}
