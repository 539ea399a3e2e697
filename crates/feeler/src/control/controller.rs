//! The hand program's decision: from tactile frames and joint angles to joint velocities.

pub use super::config::{ControlConfig, RecordingFailure, ResumePolicy};

use super::law::Law;
use super::limits::{Admitted, Request};
use super::monitor::FingerMonitor;
use super::phase::Phase;
use super::plan::Plan;
use super::sense::{FingertipPose, HandSense};
use super::stop_reason::StopReason;
use super::task::{Task, TaskConfig};
use super::touch::FingerTouch;
use crate::hand::finger::FingerGeometry;
use crate::hand::kinematics::fingertip_pose;
use crate::hand::{HandCommand, HandState, JointState};
use crate::sensor::layout::ElementLayout;
use glam::DVec3;

/// One finger as the controller drives it.
#[derive(Debug, Clone)]
pub struct FingerControl {
    geometry: FingerGeometry,
    law: Box<dyn Law>,
    /// The velocity that the control law wants of it, m/s, in W.
    pub velocity: DVec3,
    /// What the limits made of that.
    pub admitted: Admitted,
    monitor: FingerMonitor,
}

/// Task, law and limits with their memory.
#[derive(Debug, Clone)]
pub struct Controller {
    config: ControlConfig,
    fingers: Vec<FingerControl>,
    poses: Vec<FingertipPose>,
    layouts: Vec<ElementLayout>,
    task: Box<dyn Task>,
    stop_reason: Option<StopReason>,
}

impl Controller {
    /// A controller for a hand of `fingers`, each with the elements of its own of `layouts`.
    pub fn new(
        config: ControlConfig,
        task: &TaskConfig,
        fingers: &[FingerGeometry],
        layouts: &[ElementLayout],
    ) -> Self {
        Self::with_task(config, task.task(), fingers, layouts)
    }

    /// The same for a task that is not among those of [`TaskConfig`].
    pub fn with_task(
        config: ControlConfig,
        task: Box<dyn Task>,
        fingers: &[FingerGeometry],
        layouts: &[ElementLayout],
    ) -> Self {
        let most_gap = config.stale_periods.max(1.5) * config.period;
        let finger = |(geometry, layout): (&FingerGeometry, &ElementLayout)| FingerControl {
            geometry: geometry.clone(),
            law: config.law(layout.elements.len()),
            velocity: DVec3::ZERO,
            admitted: Admitted::default(),
            monitor: FingerMonitor::new(config.monitor, layout.elements.len(), most_gap),
        };
        let count = fingers.len().min(layouts.len());
        Self {
            fingers: fingers.iter().zip(layouts).map(finger).collect(),
            poses: vec![FingertipPose::default(); count],
            layouts: layouts[..count].to_vec(),
            task,
            stop_reason: None,
            config,
        }
    }

    /// The fingers as of the newest decision.
    pub fn fingers(&self) -> &[FingerControl] {
        &self.fingers
    }

    /// Where each fingertip is, by the encoders, as of the newest decision.
    pub fn poses(&self) -> &[FingertipPose] {
        &self.poses
    }

    /// The task as of the newest decision.
    pub fn task(&self) -> &dyn Task {
        &*self.task
    }

    /// Where the task stands: [`Phase::Stopped`] while the hand is stopped.
    pub fn phase(&self) -> Phase {
        match self.stop_reason {
            Some(_) => Phase::Stopped,
            None => self.task.phase(),
        }
    }

    /// Why the hand was stopped, if it was.
    pub fn stop_reason(&self) -> Option<&StopReason> {
        self.stop_reason.as_ref()
    }

    /// Decides what all fingers do for the next control period: what each finger felt and the
    /// joint state in, joint velocities out. Allocates nothing; a fault in the
    /// input stops all fingers with a [`StopReason`].
    pub fn decide(
        &mut self,
        touches: &[FingerTouch],
        state: &HandState,
        command: &mut HandCommand,
    ) {
        command.set_to_stop();
        let decided = self
            .feel(touches, state)
            .and_then(|()| self.watch(touches, state))
            .and_then(|()| self.plan(touches, state));
        if let Err(reason) = decided {
            self.stop(reason);
        }
        for (finger, velocity) in self.fingers.iter().zip(command.admitted_mut()) {
            *velocity = finger.admitted.joint_velocity;
        }
    }

    /// Stops all fingers at once, until told to [`resume`](Self::resume). The first reason is kept; but
    /// stale data may become fresh by themselves, and that must not undo what somebody said meanwhile.
    pub fn stop(&mut self, reason: StopReason) {
        let told = matches!(reason, StopReason::Told { .. });
        match &self.stop_reason {
            Some(first) if !(told && first.is_stale()) => {}
            _ => self.stop_reason = Some(reason),
        }
        for finger in &mut self.fingers {
            finger.velocity = DVec3::ZERO;
            finger.admitted = Admitted::default();
        }
    }

    /// Goes on where the hand was stopped. Where the cause is still there, the next decision stops it again.
    /// What joints and pictures did meanwhile is not held against them: somebody may have moved the fingers.
    pub fn resume(&mut self) {
        if self.stop_reason.take().is_some() {
            for finger in &mut self.fingers {
                finger.monitor.reset();
            }
        }
    }

    /// Checks what arrived, and where each finger is.
    fn feel(&mut self, touches: &[FingerTouch], state: &HandState) -> Result<(), StopReason> {
        let expected = self.fingers.len();
        check_count("tactile frames", expected, touches.len())?;
        check_count("joint states", expected, state.joints.len())?;
        let limit = self.config.stale_periods * self.config.period;
        let inputs = touches.iter().zip(&state.joints);
        let geometries = self.fingers.iter().map(|finger| &finger.geometry);
        let fingers = geometries.zip(&self.layouts).zip(&mut self.poses);
        for (finger, ((touch, joints), ((geometry, layout), pose))) in
            inputs.zip(fingers).enumerate()
        {
            check_input(finger, layout.elements.len(), touch, joints)?;
            let age = state.stamp - touch.stamp;
            // Also refuses an age that is not a number, and forces from a time to come.
            if age.is_nan() || age.abs() > limit {
                return Err(StopReason::StaleForces { finger, age, limit });
            }
            check_load(finger, touch, self.config.limits.element_force)?;
            (pose.position, pose.rotation) = fingertip_pose(geometry, joints.position);
        }
        Ok(())
    }

    /// Checks whether what the sensors of a hand under way say can be true.
    fn watch(&mut self, touches: &[FingerTouch], state: &HandState) -> Result<(), StopReason> {
        if self.stop_reason.is_some() {
            return Ok(());
        }
        let inputs = touches.iter().zip(&state.joints);
        for (index, (finger, (touch, joints))) in self.fingers.iter_mut().zip(inputs).enumerate() {
            let reading = (state.stamp, joints.position);
            let command = finger.admitted.joint_velocity;
            let monitored = (index, &finger.geometry);
            finger.monitor.watch(monitored, touch, reading, command)?;
        }
        Ok(())
    }

    /// What the task wants, what the law makes of it, and what the limits let through.
    fn plan(&mut self, touches: &[FingerTouch], state: &HandState) -> Result<(), StopReason> {
        let hand = HandSense {
            stamp: state.stamp,
            poses: &self.poses,
            touches,
            layouts: &self.layouts,
        };
        let stopped = self.stop_reason.is_some();
        if !stopped {
            self.task.advance(&hand)?;
        }
        let fingers = self.fingers.iter_mut().zip(hand.fingers());
        for (index, ((finger, sense), joints)) in fingers.zip(&state.joints).enumerate() {
            let plan = match stopped {
                true => Plan::default(),
                false => self.task.plan(index, &hand),
            };
            finger.velocity = finger.law.velocity(&plan, &sense);
            let request = Request {
                velocity: finger.velocity,
                position: sense.pose.position,
                theta: joints.position,
                previous: finger.admitted.joint_velocity,
            };
            finger.admitted = self
                .config
                .limits
                .admit(&finger.geometry, &request, self.config.period)
                .ok_or(StopReason::NotFinite {
                    finger: index,
                    what: "command",
                })?;
        }
        Ok(())
    }
}

fn check_count(what: &'static str, expected: usize, actual: usize) -> Result<(), StopReason> {
    if actual == expected {
        Ok(())
    } else {
        Err(StopReason::FingerCount {
            what,
            expected,
            actual,
        })
    }
}

fn check_input(
    finger: usize,
    elements: usize,
    touch: &FingerTouch,
    joints: &JointState,
) -> Result<(), StopReason> {
    let forces = &touch.frame.forces;
    if forces.len() != elements {
        return Err(StopReason::ElementCount {
            finger,
            expected: elements,
            actual: forces.len(),
        });
    }
    // In every step of every finger, so one pass without a branch; what is wrong is found out afterwards.
    let not_finite = |what| StopReason::NotFinite { finger, what };
    if !forces.iter().fold(true, |all, f| all & f.is_finite()) {
        let no_force = |element| StopReason::NoForce { finger, element };
        let invalid = touch.frame.first_invalid().map(no_force);
        return Err(invalid.unwrap_or_else(|| not_finite("force")));
    }
    if !(joints.position.is_finite() && joints.velocity.is_finite()) {
        return Err(not_finite("joint state"));
    }
    Ok(())
}

/// No element is pressed harder than `limit`, N, where there is one.
fn check_load(finger: usize, touch: &FingerTouch, limit: Option<f64>) -> Result<(), StopReason> {
    let Some(limit) = limit else { return Ok(()) };
    let mut forces = touch.frame.forces.iter().enumerate();
    match forces.find(|(_, force)| force.z > limit) {
        Some((element, force)) => Err(StopReason::Overload {
            finger,
            element,
            force: force.z,
            limit,
        }),
        None => Ok(()),
    }
}
