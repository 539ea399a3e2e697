//! Plays back a recording through the sensor and hand traits, step by step.

use super::recording::Recording;
use crate::messages::channels::{Joints, Tactile};
use crate::messages::efforts::Efforts;
use feeler::hand::{
    Hand, HandCommand, HandError, HandState, JointEfforts, JointState, check_finger_count,
};
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use std::iter::Peekable;
use std::vec::IntoIter;

/// A fingertip that plays back the recorded forces of one finger.
#[derive(Debug, Clone)]
pub struct RecordedSensor {
    frames: IntoIter<Tactile>,
    elements: usize,
    count: u64,
}

impl RecordedSensor {
    /// Creates the fingertip of `finger`. If the recording has no such finger, the fingertip has no frames.
    pub fn new(recording: &Recording, finger: usize) -> Self {
        let frames = recording.fingers.get(finger);
        let frames = frames.map_or(Vec::new(), |f| f.tactile.clone());
        Self {
            elements: frames.first().map_or(0, |frame| frame.forces.len()),
            frames: frames.into_iter(),
            count: 0,
        }
    }
}

impl TactileSensor for RecordedSensor {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        let count = self.count;
        let frame = self.frames.next().ok_or(SensorError::Ended { count })?;
        reading.check_elements(frame.forces.len())?;
        for (force, &recorded) in reading.forces.iter_mut().zip(&frame.forces) {
            *force = recorded.into();
        }
        reading.sequence = frame.sequence;
        reading.stamp = frame.stamp;
        self.count += 1;
        Ok(())
    }
}

/// A hand that plays back recorded joint states and ignores commands.
#[derive(Debug, Clone)]
pub struct RecordedHand {
    fingers: Vec<IntoIter<Joints>>,
    efforts: Vec<Peekable<IntoIter<Efforts>>>,
    count: u64,
}

impl RecordedHand {
    /// Creates the hand of `recording`.
    pub fn new(recording: &Recording) -> Self {
        let fingers = || recording.fingers.iter();
        let efforts = fingers().map(|f| f.efforts.clone().into_iter().peekable());
        Self {
            fingers: fingers().map(|f| f.joints.clone().into_iter()).collect(),
            efforts: efforts.collect(),
            count: 0,
        }
    }
}

impl Hand for RecordedHand {
    fn finger_count(&self) -> usize {
        self.fingers.len()
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        check_finger_count(self.fingers.len(), state.joints.len())?;
        let count = self.count;
        for (joints, recorded) in state.joints.iter_mut().zip(&mut self.fingers) {
            let recorded = recorded.next().ok_or(HandError::Ended { count })?;
            state.stamp = recorded.stamp;
            *joints = JointState {
                position: recorded.position,
                velocity: recorded.velocity,
            };
        }
        for (own, recorded) in state.efforts.iter_mut().zip(&mut self.efforts) {
            let measured = recorded.next_if(|efforts| efforts.stamp == state.stamp);
            *own = measured.map_or_else(JointEfforts::default, |efforts| efforts.joints());
        }
        self.count += 1;
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        check_finger_count(self.fingers.len(), command.joint_velocity().len())
    }
}
