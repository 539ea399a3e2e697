//! Messages that a hand's node publishes, reused to avoid allocations.

use crate::message::TactileState;
use feeler::control::FingerFlags;
use feeler::hand::JointVector;
use feeler_record::error::RecordError;
use feeler_record::messages::FingerModel;
use feeler_record::ros::{PointCloud2, Time, WrenchStamped};
use feeler_record::sensed::{Elements, taxels};
use feeler_record::tactile_array::{TactileArray, of_finger};
use feeler_record::viewers::KinematicMessages;
use feeler_record::wire::Vector3;
use feeler_record::{NO_ELEMENT, RunFacts};
use glam::DVec3;

/// Messages that describe the state of a hand.
pub struct HandMessages {
    /// Robot description, joint states and transforms.
    pub kinematics: KinematicMessages,
    /// Messages of each finger.
    pub fingers: Vec<FingerMessages>,
}

/// Tactile messages of one finger.
pub struct FingerMessages {
    /// Force (N) on the fingertip, and torque (N m) about the dome's centre.
    pub wrench: WrenchStamped,
    /// Tip position (m) of each element, and force on it (N), in the dome's frame.
    pub taxels: PointCloud2,
    /// Flags, and force on each element in the element's frame (N).
    pub tactile: TactileState,
    /// Forces, shear rates and contact, with geometry, units, rate and validity.
    pub array: TactileArray,
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
        let finger = |(finger, model): (usize, &FingerModel)| {
            let elements = Elements::of(model);
            let array = of_finger(facts, finger).unwrap_or_default();
            let taxels = taxels(finger, &elements);
            FingerMessages {
                wrench: WrenchStamped {
                    header: taxels.header.clone(),
                    ..WrenchStamped::default()
                },
                tactile: TactileState {
                    header: taxels.header.clone(),
                    ..TactileState::default()
                },
                array,
                taxels,
                elements,
            }
        };
        Ok(Self {
            kinematics: KinematicMessages::new(facts)?,
            fingers: facts.hand.iter().enumerate().map(finger).collect(),
        })
    }

    /// Sets the joint positions (rad or m) and velocities (rad/s or m/s) of the fingers, in order, and the transforms
    /// that depend on them. Transforms of fingers beyond the end of `joints` do not change.
    pub fn set_joints(
        &mut self,
        stamp: Time,
        joints: impl Iterator<Item = (JointVector, JointVector)> + Clone,
    ) {
        self.kinematics.set_joints(stamp, joints.clone());
        let angles = |finger| Some(joints.clone().nth(finger)?.0);
        self.kinematics.set_moving(stamp, angles);
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
        let forces = touch.forces.iter().copied();
        (self.array).set_sample(stamp, touch.sequence, forces, touch.shear_rate);
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
        let forces = touch.forces.iter().map(|&force| Vector3::from(force));
        tactile.forces.extend(forces);
        tactile.shear_rate.clear();
        tactile.shear_rate.extend(rates);
        tactile.slips.clear();
        tactile.slips.extend((0..touch.forces.len()).map(slips));
    }
}
