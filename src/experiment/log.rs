//! What is recorded of a run: after every control step, everything that went in and came out.

use super::{Instruments, Session};
use crate::config::{ExperimentConfig, Sensing};
use crate::control::control_loop::ControlLoop;
use crate::control::controller::FingerControl;
use crate::control::phase::Phase;
use crate::control::task::FingerSense;
use crate::control::touch::{FingerTouch, TouchSource};
use crate::hand::hand::{Hand, JointState};
use crate::record::{
    Cap, Command, Fingertip, Flags, Joints, MessageSink, NO_ELEMENT, RecordError, Recorder,
    RunFacts, Tactile, Task, TorqueSensor,
};
use crate::sensor::layout::ElementLayout;
use crate::sim::config::SimConfig;
use crate::sim::shape::ShapeConfig;
use crate::wire::Vector3;
use glam::{DQuat, DVec3};

/// Writes control steps to a recording. Messages with lists are kept and filled again.
pub struct RunLog<R = Recorder> {
    recorder: R,
    /// Undeformed feeler tips of each finger in its fingertip frame `T`, m.
    tips: Vec<Vec<DVec3>>,
    tactile: Tactile,
    flags: Flags,
    fingertip: Fingertip,
    phase: Option<Phase>,
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
            phase: None,
        }
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
        let controller = control_loop.controller();
        let inputs = (control_loop.touches().iter()).zip(&control_loop.state().joints);
        let outputs = controller.fingers().iter().zip(controller.senses());
        for (index, ((finger, sense), (touch, joints))) in outputs.zip(inputs).enumerate() {
            self.write_felt(index, touch)?;
            self.write_motion(index, stamp, finger, joints)?;
            self.write_fingertip(index, stamp, finger, sense)?;
        }
        self.recorder.torque_sensor(&TorqueSensor {
            stamp,
            torque: at.torque.torque,
            bridge_voltage: at.torque.voltage,
            counts: at.torque.counts,
        })?;
        self.recorder.cap(&Cap {
            stamp,
            angle: at.cap.angle,
            height: at.cap_centre.z,
            centre: at.cap_centre.into(),
            resisting_torque: at.cap.torque,
        })?;
        self.write_task(stamp, control_loop)
    }

    fn write_felt(&mut self, index: usize, touch: &FingerTouch) -> Result<(), RecordError> {
        let (tactile, flags) = (&touch.frame, touch.flags);
        self.tactile.sequence = tactile.sequence;
        self.tactile.stamp = tactile.stamp;
        self.tactile.forces.clear();
        self.tactile
            .forces
            .extend(tactile.forces.iter().map(|&f| Vector3::from(f)));
        self.recorder.tactile(index, &self.tactile)?;

        self.flags.stamp = tactile.stamp;
        self.flags.touch = flags.touch;
        self.flags.slip = flags.slip;
        self.flags.over = flags.over;
        self.flags.largest_element = flags.largest_element.map_or(NO_ELEMENT, |e| e as u32);
        self.flags.grasp_force = flags.grasp_force;
        self.flags.shear_rate.clear();
        self.flags.shear_rate.extend(&touch.shear_rate);
        self.recorder.flags(index, &self.flags)
    }

    fn write_motion(
        &mut self,
        index: usize,
        stamp: f64,
        finger: &FingerControl,
        joints: &JointState,
    ) -> Result<(), RecordError> {
        self.recorder.joints(
            index,
            &Joints {
                stamp,
                position: joints.position.to_array(),
                velocity: joints.velocity.to_array(),
            },
        )?;
        self.recorder.command(
            index,
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
        finger: &FingerControl,
        sense: &FingerSense,
    ) -> Result<(), RecordError> {
        let (position, rotation) = (sense.position, finger.rotation);
        self.fingertip.stamp = stamp;
        self.fingertip.position = position.into();
        self.fingertip.orientation = DQuat::from_mat3(&rotation).into();
        self.fingertip.element_tips.clear();
        let tips = self.tips.get(index).into_iter().flatten();
        let tips = tips.map(|&tip| position + rotation * tip);
        self.fingertip.element_tips.extend(tips.map(Vector3::from));
        self.recorder.fingertip(index, &self.fingertip)
    }

    fn write_task<S: TouchSource, H: Hand>(
        &mut self,
        stamp: f64,
        control_loop: &ControlLoop<S, H>,
    ) -> Result<(), RecordError> {
        let controller = control_loop.controller();
        let phase = controller.task().phase();
        let entered = self.phase.replace(phase) != Some(phase);
        let reason = match controller.stop_reason() {
            Some(reason) if entered => reason.to_string(),
            _ => String::new(),
        };
        self.recorder.task(&Task {
            stamp,
            phase,
            stroke: controller.task().stroke(),
            reason,
        })
    }
}

/// The constants of a run of `config` that its report needs.
pub fn run_facts(config: &ExperimentConfig) -> RunFacts {
    let directions = |pick: fn(&crate::control::task::FingerPathConfig) -> [f64; 3]| {
        let paths = config.task.finger.iter();
        paths
            .map(|path| DVec3::from_array(pick(path)).normalize_or_zero().to_array())
            .collect()
    };
    RunFacts {
        experiment: config.name.clone(),
        seed: config.seed,
        version: env!("CARGO_PKG_VERSION").to_string(),
        sensing: match config.sensing {
            Sensing::Image => "image".to_string(),
            Sensing::Direct => "direct".to_string(),
        },
        control_period: config.control.period,
        fingers: config.hand.finger.len(),
        cap_radius: cap_radius(&config.sim),
        feeler_tip_radius: config.sim.feeler.tip_radius,
        touch_force_threshold: config.control.touch_force,
        over_force_threshold: config.control.over_force,
        slip_threshold: config.control.slip_threshold,
        grasp_force_threshold: config.task.grasp_force,
        approach: directions(|path| path.approach),
        stroke_direction: directions(|path| path.stroke),
        stroke_count: config.task.strokes,
    }
}

/// Radius of the cap at its widest, m; 0 when there is no cap.
fn cap_radius(sim: &SimConfig) -> f64 {
    match sim.cap().map(|(_, object, _)| &object.shape) {
        Some(
            &ShapeConfig::Cylinder { radius, .. } | &ShapeConfig::KnurledCylinder { radius, .. },
        ) => radius,
        _ => 0.0,
    }
}
