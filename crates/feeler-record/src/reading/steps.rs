//! Iterates over a recording by control step.

use super::recording::{FingerRecord, Recording};
use crate::messages::channels::{
    Cap, Command, Fingertip, Flags, Joints, ObjectPose, Tactile, Task, TorqueSensor, TrueSlip,
};
use crate::messages::felt::Felt;
use crate::writing::newest::LatestAt;

/// Latest messages at a control step. `None` if no message had been recorded by then.
#[derive(Debug, Clone)]
pub struct Step<'a> {
    /// State of the task. Its stamp is the time of the step.
    pub task: &'a Task,
    /// One entry per finger.
    pub fingers: Vec<FingerStep<'a>>,
    /// Reading of the torque sensor.
    pub torque: Option<&'a TorqueSensor>,
    /// True state of the cap.
    pub cap: Option<&'a Cap>,
    /// True pose of the carried object.
    pub object: Option<&'a ObjectPose>,
    /// True slip of the feelers.
    pub true_slip: Option<&'a TrueSlip>,
    /// Rumble and tone of the live page.
    pub felt: Option<&'a Felt>,
}

impl<'a> Step<'a> {
    /// Latest messages of `finger`, or `None` if there is no such finger.
    pub fn finger(&self, finger: usize) -> Option<FingerStep<'a>> {
        self.fingers.get(finger).copied()
    }
}

/// Latest messages of one finger at a control step.
#[derive(Debug, Clone, Copy)]
pub struct FingerStep<'a> {
    /// Forces.
    pub tactile: Option<&'a Tactile>,
    /// Flags.
    pub flags: Option<&'a Flags>,
    /// Encoder readings.
    pub joints: Option<&'a Joints>,
    /// Command.
    pub command: Option<&'a Command>,
    /// Pose of the fingertip.
    pub fingertip: Option<&'a Fingertip>,
}

/// Iterator over the control steps of a recording, in order of time.
#[derive(Debug, Clone)]
pub struct Steps<'a> {
    tasks: std::slice::Iter<'a, Task>,
    fingers: Vec<FingerNewest<'a>>,
    torque: LatestAt<'a, TorqueSensor>,
    cap: LatestAt<'a, Cap>,
    object: LatestAt<'a, ObjectPose>,
    true_slip: LatestAt<'a, TrueSlip>,
    felt: LatestAt<'a, Felt>,
}

impl<'a> Steps<'a> {
    /// Creates an iterator over the steps of `recording`.
    pub fn new(recording: &'a Recording) -> Self {
        Self {
            tasks: recording.task.iter(),
            fingers: recording.fingers.iter().map(FingerNewest::new).collect(),
            torque: LatestAt::new(&recording.torque_sensor),
            cap: LatestAt::new(&recording.cap),
            object: LatestAt::new(&recording.object),
            true_slip: LatestAt::new(&recording.true_slip),
            felt: LatestAt::new(&recording.felt),
        }
    }
}

impl<'a> Iterator for Steps<'a> {
    type Item = Step<'a>;

    fn next(&mut self) -> Option<Step<'a>> {
        let task = self.tasks.next()?;
        let time = task.stamp;
        Some(Step {
            task,
            fingers: self.fingers.iter_mut().map(|f| f.at(time)).collect(),
            torque: self.torque.at(time),
            cap: self.cap.at(time),
            object: self.object.at(time),
            true_slip: self.true_slip.at(time),
            felt: self.felt.at(time),
        })
    }
}

#[derive(Debug, Clone)]
struct FingerNewest<'a> {
    tactile: LatestAt<'a, Tactile>,
    flags: LatestAt<'a, Flags>,
    joints: LatestAt<'a, Joints>,
    command: LatestAt<'a, Command>,
    fingertip: LatestAt<'a, Fingertip>,
}

impl<'a> FingerNewest<'a> {
    fn new(finger: &'a FingerRecord) -> Self {
        Self {
            tactile: LatestAt::new(&finger.tactile),
            flags: LatestAt::new(&finger.flags),
            joints: LatestAt::new(&finger.joints),
            command: LatestAt::new(&finger.command),
            fingertip: LatestAt::new(&finger.fingertip),
        }
    }

    fn at(&mut self, time: f64) -> FingerStep<'a> {
        FingerStep {
            tactile: self.tactile.at(time),
            flags: self.flags.at(time),
            joints: self.joints.at(time),
            command: self.command.at(time),
            fingertip: self.fingertip.at(time),
        }
    }
}
