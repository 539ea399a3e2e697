//! What is recorded of a run: after every control step, everything that went in and came out.

pub use super::facts::run_facts;

use super::{Instruments, Session};
use feeler::control::control_loop::ControlLoop;
use feeler::control::controller::{Controller, FingerControl};
use feeler::control::sense::FingertipPose;
use feeler::control::stop_reason::StopReason;
use feeler::control::task::Task as ControlTask;
use feeler::control::touch::{FingerTouch, TouchSource};
use feeler::hand::hand::{Hand, JointState, MAX_FINGERS};
use feeler::sensor::frame::Frame;
use feeler::sensor::layout::ElementLayout;
use feeler_record::wire::Vector3;
use feeler_record::{
    Cap, Command, Findings, Fingertip, Flags, Image, Joints, MessageSink, NO_ELEMENT, ObjectPose,
    RecordError, Recorder, Tactile, Task, TaskOutcome, TorqueSensor, TrueSlip, topics,
};
use feeler_sim::pose::Pose;
use glam::{DQuat, DVec3};

/// Writes control steps to a recording. Messages with lists are kept and filled again.
pub struct RunLog<R = Recorder> {
    recorder: R,
    /// Undeformed feeler tips of each finger in its fingertip frame `T`, m.
    tips: Vec<Vec<DVec3>>,
    tactile: Tactile,
    flags: Flags,
    fingertip: Fingertip,
    /// Why the hand is stopped, as written last.
    stop_reason: Option<StopReason>,
    findings: Findings,
    /// Each finger's newest picture, if pictures are recorded.
    pictures: Vec<Picture>,
}

/// What a rig's own instruments, and a simulated world, add to the record of a control step.
#[derive(Debug, Clone, Copy, Default)]
pub struct RigRecord<'a> {
    /// What the torque sensor says.
    pub torque: Option<&'a TorqueSensor>,
    /// How the cap stands, in truth.
    pub cap: Option<&'a Cap>,
    /// How far feelers slipped, in truth.
    pub slip: Option<&'a TrueSlip>,
}

struct Picture {
    image: Image,
    /// Its sequence number, once there is one.
    sequence: Option<u64>,
}

impl<R: MessageSink> RunLog<R> {
    /// Logs to `recorder` a run of fingertips with the elements of `layouts`, one each.
    pub fn new(recorder: R, layouts: &[ElementLayout]) -> Self {
        let tips = |layout: &ElementLayout| {
            let elements = 0..layout.elements.len();
            elements.map(|element| layout.tip(element)).collect()
        };
        Self {
            recorder,
            tips: layouts.iter().map(tips).collect(),
            tactile: Tactile::default(),
            flags: Flags::default(),
            fingertip: Fingertip {
                stamp: 0.0,
                position: DVec3::ZERO.into(),
                orientation: DQuat::IDENTITY.into(),
                element_tips: Vec::new(),
            },
            stop_reason: None,
            findings: Findings::default(),
            pictures: Vec::new(),
        }
    }

    /// The same log with each finger's pictures in it, of which the recorder has to know.
    #[must_use]
    pub fn with_pictures(mut self) -> Self {
        let picture = |finger| Picture {
            image: Image::of_finger(finger),
            sequence: None,
        };
        self.pictures = (0..self.tips.len()).map(picture).collect();
        self
    }

    /// The recorder.
    pub fn recorder_mut(&mut self) -> &mut R {
        &mut self.recorder
    }

    /// The recorder, to finish the recording.
    pub fn into_recorder(self) -> R {
        self.recorder
    }

    /// Writes the newest control step of `session` and what the instruments said at its time.
    ///
    /// # Errors
    /// When the recording cannot be written.
    pub fn write(&mut self, session: &Session, at: &Instruments) -> Result<(), RecordError> {
        let control_loop = session.control_loop();
        let stamp = control_loop.state().stamp;
        let torque = TorqueSensor {
            stamp,
            torque: at.torque.torque,
            bridge_voltage: at.torque.voltage,
            counts: at.torque.counts,
        };
        let cap = Cap {
            stamp,
            angle: at.cap.angle,
            height: at.cap_centre.z,
            centre: at.cap_centre.into(),
            resisting_torque: at.cap.torque,
        };
        if let Some(pose) = &at.object {
            self.write_object(&object_pose(stamp, pose))?;
        }
        let slip = TrueSlip {
            stamp,
            distance: at.slipped[..self.tips.len().min(MAX_FINGERS)].to_vec(),
        };
        let rig = RigRecord {
            torque: Some(&torque),
            cap: Some(&cap),
            slip: Some(&slip),
        };
        self.write_step(control_loop, rig)
    }

    /// Writes where the carried object is.
    ///
    /// # Errors
    /// When the recording cannot be written.
    pub fn write_object(&mut self, pose: &ObjectPose) -> Result<(), RecordError> {
        self.recorder.write(topics::OBJECT, pose)
    }

    /// Writes the newest step of `control_loop`, and what else is known of the `rig` at its time.
    ///
    /// # Errors
    /// When the recording cannot be written.
    pub fn write_step<S: TouchSource, H: Hand>(
        &mut self,
        control_loop: &ControlLoop<S, H>,
        rig: RigRecord<'_>,
    ) -> Result<(), RecordError> {
        let stamp = control_loop.state().stamp;
        let controller = control_loop.controller();
        let sensors = control_loop.sensors().iter();
        let inputs = sensors.zip(control_loop.touches());
        let inputs = inputs.zip(&control_loop.state().joints);
        let outputs = controller.fingers().iter().zip(controller.poses());
        for (index, ((finger, pose), ((sensor, touch), joints))) in outputs.zip(inputs).enumerate()
        {
            // Before the forces, so that a recording that is cut off has the picture of all that it has.
            self.write_picture(index, sensor.frame())?;
            self.write_felt(index, touch)?;
            self.write_motion(index, stamp, finger, joints)?;
            self.write_fingertip(index, stamp, pose)?;
        }
        if let Some(torque) = rig.torque {
            self.recorder.write(topics::TORQUE_SENSOR, torque)?;
        }
        if let Some(cap) = rig.cap {
            self.recorder.write(topics::CAP, cap)?;
        }
        if let Some(slip) = rig.slip {
            self.recorder.write(topics::TRUE_SLIP, slip)?;
        }
        self.write_findings(stamp, controller.task())?;
        self.write_task(stamp, controller)
    }

    /// Writes a finger's picture, if it is to be recorded and has not been.
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

    fn write_felt(&mut self, index: usize, touch: &FingerTouch) -> Result<(), RecordError> {
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
        self.recorder.write(
            topics::joints(index),
            &Joints {
                stamp,
                position: joints.position.to_array(),
                velocity: joints.velocity.to_array(),
            },
        )?;
        self.recorder.write(
            topics::command(index),
            &Command {
                stamp,
                joint_velocity: finger.admitted.joint_velocity.to_array(),
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
        self.fingertip.stamp = stamp;
        self.fingertip.position = position.into();
        self.fingertip.orientation = DQuat::from_mat3(&rotation).into();
        self.fingertip.element_tips.clear();
        let tips = self.tips.get(index).into_iter().flatten();
        let tips = tips.map(|&tip| position + rotation * tip);
        self.fingertip.element_tips.extend(tips.map(Vector3::from));
        self.recorder
            .write(topics::fingertip(index), &self.fingertip)
    }

    /// Writes what the task found out, if that is more than it was.
    fn write_findings(&mut self, stamp: f64, task: &dyn ControlTask) -> Result<(), RecordError> {
        let (found, outcome) = (task.findings(), task.outcome());
        let written = self.findings.names.iter().zip(&self.findings.values);
        // To the bit, so that what is not a number is not new for ever.
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
        // A hand that stands still for want of data may be told to stop, too: both are written.
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

fn object_pose(stamp: f64, pose: &Pose) -> ObjectPose {
    ObjectPose {
        stamp,
        position: pose.position.into(),
        orientation: DQuat::from_mat3(&pose.rotation).into(),
    }
}
