//! Records all inputs and outputs of a control loop after every control step.

use crate::error::RecordError;
use crate::messages::channels::{
    Command, Findings, Fingertip, Flags, Joints, NO_ELEMENT, Tactile, TactileSample, Task,
};
use crate::messages::efforts::Efforts;
use crate::messages::facts::RunFacts;
use crate::messages::felt::Felt;
use crate::messages::image::Image;
use crate::messages::names::TaskOutcome;
use crate::messages::topic::topics;
use crate::viewers::viewer_log::ViewerLog;
use crate::wire::Vector3;
use crate::writing::instruments::InstrumentRecord;
use crate::writing::memory::MessageSink;
use crate::writing::recorder::Recorder;
use feeler::control::task::Task as ControlTask;
use feeler::control::{
    ControlLoop, Controller, FingerControl, FingertipPose, StopReason, TactileReading,
    TactileSource,
};
use feeler::hand::{Hand, JointState};
use feeler::sensor::forces::TactileFrame;
use feeler::sensor::image::Frame;
use glam::DQuat;

/// Writes control steps to a recording. The memory of messages with lists is reused.
pub struct RunLog<R = Recorder> {
    recorder: R,
    fingers: usize,
    /// Messages for viewers, if the recorder needs them and the hand's geometry is known.
    viewer: Option<ViewerLog>,
    tactile: Tactile,
    sample: TactileSample,
    flags: Flags,
    /// Stop reason as last written.
    stop_reason: Option<StopReason>,
    findings: Findings,
    /// Latest image of each finger, if images are recorded.
    pictures: Vec<RecordedPicture>,
    /// Reused message, if efforts are recorded.
    efforts: Option<Efforts>,
}

struct RecordedPicture {
    image: Image,
    /// Sequence number of the image, if any.
    sequence: Option<u64>,
}

impl<R: MessageSink> RunLog<R> {
    /// Creates a log that writes the run described by `facts` to `recorder`.
    ///
    /// # Errors
    /// If the constants are invalid.
    pub fn new(recorder: R, facts: &RunFacts) -> Result<Self, RecordError> {
        let viewer = match recorder.is_for_viewers() {
            true => ViewerLog::new(facts)?,
            false => None,
        };
        Ok(Self {
            recorder,
            fingers: facts.fingers,
            viewer,
            tactile: Tactile::default(),
            sample: TactileSample::default(),
            flags: Flags::default(),
            stop_reason: None,
            findings: Findings::default(),
            pictures: Vec::new(),
            efforts: None,
        })
    }

    /// Also logs the efforts of the drives. The recorder must have been created with efforts.
    #[must_use]
    pub fn with_efforts(mut self) -> Self {
        self.efforts = Some(Efforts::default());
        self
    }

    /// Also logs each finger's images. The recorder must have been created with images.
    #[must_use]
    pub fn with_pictures(mut self) -> Self {
        let picture = |finger| RecordedPicture {
            image: Image::of_finger(finger),
            sequence: None,
        };
        self.pictures = (0..self.fingers).map(picture).collect();
        self
    }

    /// Returns the recorder.
    pub fn recorder_mut(&mut self) -> &mut R {
        &mut self.recorder
    }

    /// Returns the recorder, to finish the recording.
    pub fn into_recorder(self) -> R {
        self.recorder
    }

    /// Writes the latest step of `control_loop` and the readings of the `instruments` at its time.
    ///
    /// # Errors
    /// If the recording cannot be written.
    pub fn write<S: TactileSource, H: Hand>(
        &mut self,
        control_loop: &ControlLoop<S, H>,
        instruments: InstrumentRecord<'_>,
    ) -> Result<(), RecordError> {
        if let Some(object) = instruments.object {
            self.recorder.write(topics::OBJECT, object)?;
        }
        let stamp = control_loop.state().stamp;
        let controller = control_loop.controller();
        let sensors = control_loop.sensors().iter();
        let inputs = sensors.zip(control_loop.touches());
        let inputs = inputs.zip(&control_loop.state().joints);
        let outputs = controller.fingers().iter().zip(controller.poses());
        for (index, ((finger, pose), ((sensor, touch), joints))) in outputs.zip(inputs).enumerate()
        {
            // Written before the forces, so that a truncated recording contains the image of every tactile frame.
            self.write_picture(index, sensor.frame())?;
            self.write_samples(index, sensor.earlier_frames())?;
            self.write_touch(index, touch)?;
            self.write_motion(index, stamp, finger, joints)?;
            self.write_fingertip(index, stamp, pose)?;
        }
        if let Some(message) = &mut self.efforts {
            for (index, efforts) in control_loop.state().efforts.iter().enumerate() {
                message.set(stamp, efforts);
                self.recorder.write(topics::efforts(index), message)?;
            }
        }
        if let Some(torque) = instruments.torque {
            self.recorder.write(topics::TORQUE_SENSOR, torque)?;
        }
        if let Some(cap) = instruments.cap {
            self.recorder.write(topics::CAP, cap)?;
        }
        if let Some(slip) = instruments.slip {
            self.recorder.write(topics::TRUE_SLIP, slip)?;
        }
        self.write_findings(stamp, controller.task())?;
        self.write_task(stamp, controller)?;
        if let Some(viewer) = &mut self.viewer {
            viewer.write(&mut self.recorder, control_loop, instruments)?;
        }
        if !self.recorder.step_ends()? {
            self.forget_written();
        }
        Ok(())
    }

    /// Writes rumble and tone of the live page. The recorder must have been created with them.
    ///
    /// # Errors
    /// If the recording cannot be written.
    pub fn write_felt(&mut self, felt: &Felt) -> Result<(), RecordError> {
        self.recorder.write(topics::FELT, felt)
    }

    /// Requests that messages written only on change are written again, because they may have been dropped.
    fn forget_written(&mut self) {
        self.findings = Findings::default();
        self.stop_reason = None;
        for picture in &mut self.pictures {
            picture.sequence = None;
        }
        if let Some(viewer) = &mut self.viewer {
            viewer.forget_written();
        }
    }

    /// Writes a finger's image if images are recorded and this one has not been written.
    fn write_picture(&mut self, index: usize, frame: Option<&Frame>) -> Result<(), RecordError> {
        let (Some(picture), Some(frame)) = (self.pictures.get_mut(index), frame) else {
            return Ok(());
        };
        if picture.sequence.replace(frame.sequence) == Some(frame.sequence) {
            return Ok(());
        }
        picture.image.fill(frame)?;
        self.recorder.write(topics::image(index), &picture.image)
    }

    /// Writes the tactile frames of a finger between this step and the one before.
    fn write_samples(&mut self, index: usize, frames: &[TactileFrame]) -> Result<(), RecordError> {
        for frame in frames {
            (self.sample.sequence, self.sample.stamp) = (frame.sequence, frame.stamp);
            self.sample.forces.clear();
            let forces = frame.forces.iter().map(|&force| Vector3::from(force));
            self.sample.forces.extend(forces);
            self.recorder.write(topics::samples(index), &self.sample)?;
        }
        Ok(())
    }

    fn write_touch(&mut self, index: usize, touch: &TactileReading) -> Result<(), RecordError> {
        let (tactile, flags) = (&touch.frame, touch.flags);
        self.tactile.sequence = tactile.sequence;
        self.tactile.stamp = tactile.stamp;
        self.tactile.forces.clear();
        self.tactile
            .forces
            .extend(tactile.forces.iter().map(|&f| Vector3::from(f)));
        self.recorder.write(topics::tactile(index), &self.tactile)?;

        self.flags.stamp = tactile.stamp;
        self.flags.touch = flags.touch;
        self.flags.slip = flags.slip;
        self.flags.over = flags.over;
        self.flags.largest_element = flags.largest_element.map_or(NO_ELEMENT, |e| e as u32);
        self.flags.grasp_force = flags.grasp_force;
        self.flags.shear_rate.clear();
        self.flags.shear_rate.extend(&touch.shear_rate);
        self.recorder.write(topics::flags(index), &self.flags)
    }

    fn write_motion(
        &mut self,
        index: usize,
        stamp: f64,
        finger: &FingerControl,
        joints: &JointState,
    ) -> Result<(), RecordError> {
        let count = finger.geometry().joint_count();
        self.recorder.write(
            topics::joints(index),
            &Joints {
                stamp,
                position: joints.position.padded(count),
                velocity: joints.velocity.padded(count),
            },
        )?;
        self.recorder.write(
            topics::command(index),
            &Command {
                stamp,
                joint_velocity: finger.admitted.joint_velocity.padded(count),
                fingertip_velocity: finger.velocity.into(),
                limited: finger.admitted.limited,
                damping: finger.admitted.damping,
            },
        )
    }

    fn write_fingertip(
        &mut self,
        index: usize,
        stamp: f64,
        pose: &FingertipPose,
    ) -> Result<(), RecordError> {
        let FingertipPose { position, rotation } = *pose;
        self.recorder.write(
            topics::fingertip(index),
            &Fingertip {
                stamp,
                position: position.into(),
                orientation: DQuat::from_mat3(&rotation).into(),
            },
        )
    }

    /// Writes the task's findings if they changed.
    fn write_findings(&mut self, stamp: f64, task: &dyn ControlTask) -> Result<(), RecordError> {
        let (found, outcome) = (task.findings(), task.outcome());
        let written = self.findings.names.iter().zip(&self.findings.values);
        // Compares bits, so that NaN does not count as a change.
        let same = written
            .map(|(name, value)| (name.as_str(), value.to_bits()))
            .eq(found
                .iter()
                .map(|finding| (finding.name, finding.value.to_bits())));
        if same && self.findings.outcome.as_ref().map(TaskOutcome::as_str) == outcome {
            return Ok(());
        }
        self.findings = Findings {
            stamp,
            outcome: outcome.map(TaskOutcome::from),
            names: found.iter().map(|f| f.name.into()).collect(),
            values: found.iter().map(|f| f.value).collect(),
        };
        self.recorder.write(topics::FINDINGS, &self.findings)
    }

    fn write_task(&mut self, stamp: f64, controller: &Controller) -> Result<(), RecordError> {
        let mut reason = String::new();
        // A hand that is stopped for lack of data may also be stopped on request; both reasons are written.
        if self.stop_reason.as_ref() != controller.stop_reason() {
            self.stop_reason = controller.stop_reason().cloned();
            reason = (self.stop_reason.as_ref()).map_or_else(String::new, ToString::to_string);
        }
        self.recorder.write(
            topics::TASK,
            &Task {
                stamp,
                phase: controller.phase(),
                stroke: controller.task().stroke(),
                reason,
            },
        )
    }
}
