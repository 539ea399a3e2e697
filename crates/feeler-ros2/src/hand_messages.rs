//! Messages that a hand's node publishes, reused to avoid allocations.

use crate::message::TactileState;
use feeler::control::FingerFlags;
use feeler_record::error::RecordError;
use feeler_record::messages::{Frame, joint_names};
use feeler_record::ros::{
    Header, JointState, PointCloud2, TFMessage, Text, Time, TransformStamped, WrenchStamped,
};
use feeler_record::sensed::{Elements, taxels};
use feeler_record::viewers::urdf;
use feeler_record::{NO_ELEMENT, RunFacts};
use glam::DVec3;

/// Messages that describe the state of a hand.
pub struct HandMessages {
    /// Robot description (URDF).
    pub description: Text,
    /// Transforms of fixed frames.
    pub still: TFMessage,
    /// Transforms of frames that move with a joint.
    pub moving: TFMessage,
    /// Joint angles and velocities.
    pub joints: JointState,
    /// Messages of each finger.
    pub fingers: Vec<FingerMessages>,
    /// Frames of `moving`, each with the index of its finger.
    frames: Vec<(usize, Frame)>,
}

/// Tactile messages of one finger.
pub struct FingerMessages {
    /// Force (N) and torque (N m) on the fingertip, about the dome's centre.
    pub wrench: WrenchStamped,
    /// Tip position (m) of each element and force on it (N), in the dome's frame.
    pub taxels: PointCloud2,
    /// Flags, and force on each element in the element's frame (N).
    pub tactile: TactileState,
    elements: Elements,
}

/// Tactile state of one finger, computed from one image.
#[derive(Debug, Clone, Copy)]
pub struct Touch<'a> {
    /// Sequence number of the image.
    pub sequence: u64,
    /// Flags TOUCH, SLIP and OVER, the element with the largest force, and the grasp force.
    pub flags: &'a FingerFlags,
    /// Force on each element in the element's frame (N); NaN if unknown.
    pub forces: &'a [DVec3],
    /// Shear rate |d(F_x, F_y)/dt| of each element (N/s).
    pub shear_rate: &'a [f64],
    /// Shear rate above which an element slips (N/s).
    pub slip_threshold: f64,
}

impl HandMessages {
    /// Creates the messages of the hand described by `facts`.
    ///
    /// # Errors
    /// If `facts` are invalid or do not describe a hand.
    pub fn new(facts: &RunFacts) -> Result<Self, RecordError> {
        if facts.hand.is_empty() {
            return Err(RecordError::Facts {
                field: "hand",
                expected: "a model of each finger".into(),
                actual: "nothing".into(),
            });
        }
        let mut messages = Self {
            description: Text {
                data: urdf(&facts.experiment, &facts.hand, &facts.solids)?,
                stamp: 0.0,
            },
            still: TFMessage::default(),
            moving: TFMessage::default(),
            joints: JointState::default(),
            fingers: Vec::new(),
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
            let elements = Elements::of(model);
            let taxels = taxels(finger, &elements);
            messages.fingers.push(FingerMessages {
                wrench: WrenchStamped {
                    header: taxels.header.clone(),
                    ..WrenchStamped::default()
                },
                tactile: TactileState {
                    header: taxels.header.clone(),
                    ..TactileState::default()
                },
                taxels,
                elements,
            });
        }
        Ok(messages)
    }

    /// Sets the joint angles (rad) and velocities (rad/s) of the fingers, in order, and the transforms that depend on
    /// them. Transforms of fingers beyond the end of `joints` do not change.
    pub fn set_joints(
        &mut self,
        stamp: Time,
        joints: impl Iterator<Item = (DVec3, DVec3)> + Clone,
    ) {
        self.joints.header.stamp = stamp;
        self.joints.position.clear();
        self.joints.velocity.clear();
        for (position, velocity) in joints.clone() {
            self.joints.position.extend(position.to_array());
            self.joints.velocity.extend(velocity.to_array());
        }
        for ((finger, frame), place) in self.frames.iter().zip(&mut self.moving.transforms) {
            let Some((angles, _)) = joints.clone().nth(*finger) else {
                continue;
            };
            place.header.stamp = stamp;
            place.transform = frame
                .in_parent(frame.joint.map_or(0.0, |joint| angles[joint]))
                .into();
        }
    }

    /// Sets the stamp of the fixed transforms.
    pub fn set_still(&mut self, stamp: Time) {
        for place in &mut self.still.transforms {
            place.header.stamp = stamp;
        }
    }
}

impl FingerMessages {
    /// Sets all messages to the tactile state `touch`, measured at `stamp`.
    pub fn set(&mut self, stamp: Time, touch: &Touch) {
        for header in [
            &mut self.wrench.header,
            &mut self.taxels.header,
            &mut self.tactile.header,
        ] {
            header.stamp = stamp;
        }
        self.elements.take_forces(touch.forces);
        self.wrench.wrench = self.elements.wrench();
        let rates = touch.shear_rate;
        let slips = |element: usize| {
            rates
                .get(element)
                .is_some_and(|rate| *rate > touch.slip_threshold)
        };
        self.elements.fill(&mut self.taxels, slips);
        let Self { tactile, .. } = self;
        let FingerFlags {
            touch: touches,
            slip,
            over,
            largest_element,
            grasp_force,
        } = *touch.flags;
        (tactile.sequence, tactile.grasp_force) = (touch.sequence, grasp_force);
        (tactile.touch, tactile.slip, tactile.over) = (touches, slip, over);
        let largest = largest_element.and_then(|element| u32::try_from(element).ok());
        tactile.largest_element = largest.unwrap_or(NO_ELEMENT);
        tactile.forces.clear();
        tactile.forces.extend(
            touch
                .forces
                .iter()
                .map(|&force| feeler_record::wire::Vector3::from(force)),
        );
        tactile.shear_rate.clear();
        tactile.shear_rate.extend(rates);
        tactile.slips.clear();
        tactile.slips.extend((0..touch.forces.len()).map(slips));
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
