//! Messages of a hand's kinematics: robot description, joint states and transforms.

use super::urdf::urdf;
use crate::error::RecordError;
use crate::messages::channels::recorded_joints;
use crate::messages::facts::RunFacts;
use crate::messages::model::{Frame, joint_names};
use crate::ros::{Header, JointState, TFMessage, Text, Time, TransformStamped};
use feeler::hand::JointVector;

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
        };
        for (finger, model) in facts.hand.iter().enumerate() {
            messages.joints.name.extend(joint_names(finger));
            for frame in model.frames(finger)? {
                let place = transform(&frame);
                if frame.joint.is_none() {
                    messages.still.transforms.push(place);
                } else {
                    messages.moving.transforms.push(place);
                    messages.frames.push((finger, frame));
                }
            }
        }
        Ok(messages)
    }

    /// Sets the joint angles (rad) and velocities (rad/s) of the fingers, in order.
    ///
    /// # Errors
    /// If a finger has more joints than a recording can contain.
    pub fn set_joints(
        &mut self,
        stamp: Time,
        joints: impl Iterator<Item = (JointVector, JointVector)>,
    ) -> Result<(), RecordError> {
        self.joints.header.stamp = stamp;
        self.joints.position.clear();
        self.joints.velocity.clear();
        for (position, velocity) in joints {
            self.joints.position.extend(recorded_joints(position)?);
            self.joints.velocity.extend(recorded_joints(velocity)?);
        }
        Ok(())
    }

    /// Sets the transforms of moving frames. `angles` returns the joint angles of a finger (rad), or `None` to keep its
    /// transforms.
    pub fn set_moving(&mut self, stamp: Time, angles: impl Fn(usize) -> Option<JointVector>) {
        for ((finger, frame), place) in self.frames.iter().zip(&mut self.moving.transforms) {
            let Some(angles) = angles(*finger) else {
                continue;
            };
            let angle = frame.joint.map_or(0.0, |joint| angles[joint]);
            place.header.stamp = stamp;
            place.transform = frame.in_parent(angle).into();
        }
    }

    /// Sets the stamp of the fixed transforms.
    pub fn set_still(&mut self, stamp: Time) {
        for place in &mut self.still.transforms {
            place.header.stamp = stamp;
        }
    }
}

/// Returns the transform of `frame` to its parent at joint angle 0.
fn transform(frame: &Frame) -> TransformStamped {
    TransformStamped {
        header: Header::of(frame.parent.as_str()),
        child_frame_id: frame.name.clone(),
        transform: frame.in_parent(0.0).into(),
    }
}
