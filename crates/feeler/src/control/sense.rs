//! Sensor readings of a hand in one control step, the input of tasks and control laws.

use super::flags::FingerFlags;
use super::touch::TactileReading;
use crate::hand::{HandState, JointState};
use crate::sensor::fingertip::layout::ElementLayout;
use glam::{DMat3, DVec3};

/// Pose of a fingertip, computed from the joint angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingertipPose {
    /// Position of the dome's centre (m, in W).
    pub position: DVec3,
    /// Rotation from the fingertip frame `T` to W.
    pub rotation: DMat3,
}

impl Default for FingertipPose {
    fn default() -> Self {
        Self {
            position: DVec3::ZERO,
            rotation: DMat3::IDENTITY,
        }
    }
}

/// Readings and pose of one finger.
#[derive(Debug, Clone, Copy)]
pub struct FingerReadings<'a> {
    /// Pose of the fingertip.
    pub pose: FingertipPose,
    /// Joint angles and velocities from the encoders.
    pub joints: JointState,
    /// Forces on all elements, their shear rates and the flags.
    pub touch: &'a TactileReading,
    /// Positions of the elements on the dome.
    pub layout: &'a ElementLayout,
}

impl FingerReadings<'_> {
    /// Contact flags TOUCH, SLIP and OVER, and grasp force.
    pub fn flags(&self) -> &FingerFlags {
        &self.touch.flags
    }

    /// Outward normal of the dome at `element`, a unit vector in W; `None` if there is no such element.
    pub fn normal(&self, element: usize) -> Option<DVec3> {
        let element = self.layout.elements.get(element)?;
        Some(self.pose.rotation * element.normal())
    }

    /// Force on the feeler of `element` by the object (N, in W); zero if there is no such element.
    pub fn force(&self, element: usize) -> DVec3 {
        let force = self.touch.frame.forces.get(element);
        let element = self.layout.elements.get(element);
        let (Some(force), Some(element)) = (force, element) else {
            return DVec3::ZERO;
        };
        self.pose.rotation * element.force_on_fingertip(*force)
    }

    /// Resultant force on the fingertip by the object (N, in W); see
    /// [`TactileFrame::resultant`](crate::sensor::forces::reading::TactileFrame::resultant).
    pub fn resultant(&self) -> DVec3 {
        self.pose.rotation * self.touch.frame.resultant(self.layout)
    }
}

/// Readings of the whole hand in one control step.
#[derive(Debug, Clone, Copy)]
pub struct HandReadings<'a> {
    /// Time of the control step (s).
    pub stamp: f64,
    /// Pose of each fingertip.
    pub poses: &'a [FingertipPose],
    /// Joint angles and velocities of each finger.
    pub joints: &'a [JointState],
    /// Tactile reading of each finger since the last control step.
    pub touches: &'a [TactileReading],
    /// Element layout of each finger.
    pub layouts: &'a [ElementLayout],
    /// `true` for each finger that the control law considers closed on the object. If `None` or missing, the task
    /// decides.
    pub closed: &'a [Option<bool>],
}

impl<'a> HandReadings<'a> {
    /// Combines the encoder readings `state` with the tactile readings, fingertip poses and element layouts of all
    /// fingers.
    pub fn new(
        state: &'a HandState,
        touches: &'a [TactileReading],
        poses: &'a [FingertipPose],
        layouts: &'a [ElementLayout],
    ) -> Self {
        Self {
            stamp: state.stamp,
            poses,
            joints: &state.joints,
            touches,
            layouts,
            closed: &[],
        }
    }

    /// Returns whether `finger` has closed on the object. If the control law does not decide, the grasp force must be
    /// at least `grasp_force` (N). `false` if there is no such finger.
    pub fn has_closed(&self, finger: usize, grasp_force: f64) -> bool {
        let by_force = || {
            let touch = self.touches.get(finger);
            touch.is_some_and(|touch| touch.flags.grasp_force >= grasp_force)
        };
        let by_law = self.closed.get(finger).copied().flatten();
        by_law.unwrap_or_else(by_force)
    }

    /// Readings of one finger, or `None` if there is no such finger.
    pub fn finger(&self, finger: usize) -> Option<FingerReadings<'a>> {
        Some(FingerReadings {
            pose: *self.poses.get(finger)?,
            joints: *self.joints.get(finger)?,
            touch: self.touches.get(finger)?,
            layout: self.layouts.get(finger)?,
        })
    }

    /// Iterates over the readings of all fingers.
    pub fn fingers(&self) -> impl Iterator<Item = FingerReadings<'a>> + use<'a> {
        let stand = self.poses.iter().zip(self.joints);
        let fingers = stand.zip(self.touches).zip(self.layouts);
        fingers.map(|(((&pose, &joints), touch), layout)| FingerReadings {
            pose,
            joints,
            touch,
            layout,
        })
    }
}
