//! What a hand feels in one control step: all that tasks and control laws decide on.

use super::flags::FingerFlags;
use super::touch::FingerTouch;
use crate::hand::{HandState, JointState};
use crate::sensor::layout::ElementLayout;
use glam::{DMat3, DVec3};

/// Where a fingertip is, by its encoders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingertipPose {
    /// Its dome's centre, m, in W.
    pub position: DVec3,
    /// Rotation from its frame `T` to W.
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

/// What one finger feels, and where.
#[derive(Debug, Clone, Copy)]
pub struct FingerSense<'a> {
    /// Where its fingertip is.
    pub pose: FingertipPose,
    /// Its joint angles and velocities, by its encoders.
    pub joints: JointState,
    /// The forces on all its elements, their shear rates and the flags.
    pub touch: &'a FingerTouch,
    /// Where its elements sit on the dome.
    pub layout: &'a ElementLayout,
}

impl FingerSense<'_> {
    /// TOUCH, SLIP, OVER and grasp force.
    pub fn flags(&self) -> &FingerFlags {
        &self.touch.flags
    }

    /// The dome's outward normal at `element`, a unit vector in W; none where there is no such element.
    pub fn normal(&self, element: usize) -> Option<DVec3> {
        let element = self.layout.elements.get(element)?;
        Some(self.pose.rotation * element.normal())
    }

    /// Force on the feeler of `element` by what it touches, N, in W; zero where there is no such element.
    pub fn force(&self, element: usize) -> DVec3 {
        let force = self.touch.frame.forces.get(element);
        let element = self.layout.elements.get(element);
        let (Some(force), Some(element)) = (force, element) else {
            return DVec3::ZERO;
        };
        self.pose.rotation * element.force_on_fingertip(*force)
    }

    /// Resultant force on the fingertip by what it touches, N, in W; see
    /// [`TactileFrame::resultant`](crate::sensor::reading::TactileFrame::resultant).
    pub fn resultant(&self) -> DVec3 {
        self.pose.rotation * self.touch.frame.resultant(self.layout)
    }
}

/// What the whole hand feels in one control step.
#[derive(Debug, Clone, Copy)]
pub struct HandSense<'a> {
    /// Time of the control step, s.
    pub stamp: f64,
    /// Where each fingertip is.
    pub poses: &'a [FingertipPose],
    /// Each finger's joint angles and velocities.
    pub joints: &'a [JointState],
    /// What each finger felt since the last control step.
    pub touches: &'a [FingerTouch],
    /// The elements of each finger.
    pub layouts: &'a [ElementLayout],
    /// Whether the control law considers each finger closed on the object; `None`, and missing for a finger, if the
    /// law leaves that to the task.
    pub closed: &'a [Option<bool>],
}

impl<'a> HandSense<'a> {
    /// What fingers with elements as in `layouts` feel, whose encoders say `state`: `touches`, with their tips at `poses`.
    pub fn new(
        state: &'a HandState,
        touches: &'a [FingerTouch],
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

    /// Whether `finger` has closed on the object: as the control law says, or else if its grasp force is at least
    /// `grasp_force` (N). `false` if there is no such finger.
    pub fn has_closed(&self, finger: usize, grasp_force: f64) -> bool {
        let by_force = || {
            let touch = self.touches.get(finger);
            touch.is_some_and(|touch| touch.flags.grasp_force >= grasp_force)
        };
        let by_law = self.closed.get(finger).copied().flatten();
        by_law.unwrap_or_else(by_force)
    }

    /// One finger, if there is such a finger.
    pub fn finger(&self, finger: usize) -> Option<FingerSense<'a>> {
        Some(FingerSense {
            pose: *self.poses.get(finger)?,
            joints: *self.joints.get(finger)?,
            touch: self.touches.get(finger)?,
            layout: self.layouts.get(finger)?,
        })
    }

    /// The fingers, one after the other.
    pub fn fingers(&self) -> impl Iterator<Item = FingerSense<'a>> + use<'a> {
        let stand = self.poses.iter().zip(self.joints);
        let fingers = stand.zip(self.touches).zip(self.layouts);
        fingers.map(|(((&pose, &joints), touch), layout)| FingerSense {
            pose,
            joints,
            touch,
            layout,
        })
    }
}
