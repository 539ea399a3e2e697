//! The hand program's decision: from tactile frames and joint angles to joint velocities.

pub use super::config::{ControlConfig, RecordingFailure, ResumePolicy};

use super::input_check::{check_count, check_input, check_load};
use super::law::{FingerLaws, HandLaw, Law, LawError};
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
use crate::hand::{HandCommand, HandState};
use crate::sensor::layout::ElementLayout;
use glam::DVec3;

/// One finger as the controller drives it.
#[derive(Debug, Clone)]
pub struct FingerControl {
    geometry: FingerGeometry,
    /// The velocity that the control law, or who acts in its place, wants of it, m/s, in W.
    pub velocity: DVec3,
    /// What the limits made of that.
    pub admitted: Admitted,
    monitor: FingerMonitor,
}

impl FingerControl {
    /// Its links and joints.
    pub fn geometry(&self) -> &FingerGeometry {
        &self.geometry
    }
}

/// Task, law and limits with their memory.
#[derive(Debug, Clone)]
pub struct Controller {
    config: ControlConfig,
    fingers: Vec<FingerControl>,
    poses: Vec<FingertipPose>,
    layouts: Vec<ElementLayout>,
    task: Box<dyn Task>,
    law: Box<dyn HandLaw>,
    /// Whether the law considers each finger closed; see [`HandSense::closed`].
    closed: Vec<Option<bool>>,
    /// Velocity of each fingertip by the law, m/s, in W.
    velocities: Vec<DVec3>,
    /// What the task wants of each finger.
    plans: Vec<Plan>,
    /// Whether the newest input was found good and has not been acted on.
    planned: bool,
    stop_reason: Option<StopReason>,
}

impl Controller {
    /// A controller for a hand of `fingers`, each with the elements of its own of `layouts`.
    ///
    /// # Errors
    /// When the law is a policy that was not read, or is for other fingertips.
    pub fn new(
        config: ControlConfig,
        task: &TaskConfig,
        fingers: &[FingerGeometry],
        layouts: &[ElementLayout],
    ) -> Result<Self, LawError> {
        Self::with_task(config, task.task(), fingers, layouts)
    }

    /// The same for a task that is not among those of [`TaskConfig`].
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_task(
        config: ControlConfig,
        task: Box<dyn Task>,
        fingers: &[FingerGeometry],
        layouts: &[ElementLayout],
    ) -> Result<Self, LawError> {
        let most_gap = config.stale_periods.max(1.5) * config.period;
        let finger = |(geometry, layout): (&FingerGeometry, &ElementLayout)| {
            let elements = layout.elements.len();
            FingerControl {
                geometry: geometry.clone(),
                velocity: DVec3::ZERO,
                admitted: Admitted::default(),
                monitor: FingerMonitor::new(config.monitor, elements, most_gap),
            }
        };
        let fingers: Vec<_> = fingers.iter().zip(layouts).map(finger).collect();
        let count = fingers.len();
        Ok(Self {
            fingers,
            poses: vec![FingertipPose::default(); count],
            layouts: layouts[..count].to_vec(),
            task,
            law: config.hand_law(&layouts[..count])?,
            closed: vec![None; count],
            velocities: vec![DVec3::ZERO; count],
            plans: vec![Plan::default(); count],
            planned: false,
            stop_reason: None,
            config,
        })
    }

    /// The fingers as of the newest decision.
    pub fn fingers(&self) -> &[FingerControl] {
        &self.fingers
    }

    /// Gives each finger, by its number, the law that `law` makes for it, in place of the one it has.
    pub fn set_laws(&mut self, law: impl Fn(usize) -> Box<dyn Law>) {
        let laws = (0..self.fingers.len()).map(law).collect();
        self.law = Box::new(FingerLaws::new(laws));
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

    /// What the task wants of each finger, as of the newest decision; nothing while the hand is stopped.
    pub fn plans(&self) -> &[Plan] {
        &self.plans
    }

    /// What all fingers feel, where they are as of the newest decision.
    pub fn hand_sense<'a>(
        &'a self,
        touches: &'a [FingerTouch],
        state: &'a HandState,
    ) -> HandSense<'a> {
        HandSense {
            closed: &self.closed,
            ..HandSense::new(state, touches, &self.poses, &self.layouts)
        }
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
        self.plan(touches, state);
        self.obey(touches, state, command);
    }

    /// The first half of a [decision](Self::decide), for whoever acts in place of the laws: checks what arrived and asks the
    /// task for its [`plans`](Self::plans). [`follow`](Self::follow) is the other half.
    pub fn plan(&mut self, touches: &[FingerTouch], state: &HandState) {
        let planned = self
            .feel(touches, state)
            .and_then(|()| self.watch(touches, state))
            .and_then(|()| self.ask_task(touches, state));
        self.planned = planned.is_ok();
        if let Err(reason) = planned {
            self.stop(reason);
        }
    }

    /// The second half of a [decision](Self::decide) after [`plan`](Self::plan), as the laws say.
    pub fn obey(&mut self, touches: &[FingerTouch], state: &HandState, command: &mut HandCommand) {
        if self.planned {
            self.obey_laws(touches, state);
        }
        self.admit(state, command);
    }

    /// The second half of a [decision](Self::decide) after [`plan`](Self::plan), with these velocities of the fingertips in place of
    /// the laws', m/s, in W. They pass the same limits. A velocity that is missing or not finite stops all fingers with a
    /// [`StopReason`]; while the hand is stopped, or after no new plan, nothing moves.
    pub fn follow(&mut self, velocities: &[DVec3], state: &HandState, command: &mut HandCommand) {
        let count = check_count("velocities", self.fingers.len(), velocities.len());
        if let Err(reason) = count {
            self.stop(reason);
        }
        if self.stop_reason.is_none() {
            for (finger, &velocity) in self.fingers.iter_mut().zip(velocities) {
                finger.velocity = velocity;
            }
        }
        self.admit(state, command);
    }

    /// Stops all fingers at once, until told to [`resume`](Self::resume). The first reason is kept; but
    /// stale data may become fresh by themselves, and that must not undo what somebody said meanwhile.
    pub fn stop(&mut self, reason: StopReason) {
        let told = matches!(reason, StopReason::Told { .. });
        match &self.stop_reason {
            Some(first) if !(told && first.is_stale()) => {}
            _ => self.stop_reason = Some(reason),
        }
        self.plans.fill(Plan::default());
        self.rest();
    }

    fn rest(&mut self) {
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

    /// Asks the task what it wants of each finger.
    fn ask_task(&mut self, touches: &[FingerTouch], state: &HandState) -> Result<(), StopReason> {
        if self.stop_reason.is_some() {
            return Ok(());
        }
        let hand = HandSense::new(state, touches, &self.poses, &self.layouts);
        self.law.observe(&hand, &mut self.closed);
        let hand = HandSense {
            closed: &self.closed,
            ..hand
        };
        self.task.advance(&hand)?;
        for (finger, plan) in self.plans.iter_mut().enumerate() {
            *plan = self.task.plan(finger, &hand);
        }
        Ok(())
    }

    /// What the law of each finger makes of its plan.
    fn obey_laws(&mut self, touches: &[FingerTouch], state: &HandState) {
        let hand = HandSense::new(state, touches, &self.poses, &self.layouts);
        self.law
            .velocities(&self.plans, &hand, &mut self.velocities);
        for (finger, &velocity) in self.fingers.iter_mut().zip(&self.velocities) {
            finger.velocity = velocity;
        }
    }

    /// Makes the command of what the limits let through of each finger's velocity: once for each plan.
    fn admit(&mut self, state: &HandState, command: &mut HandCommand) {
        command.set_to_stop();
        match std::mem::take(&mut self.planned) {
            false => self.rest(),
            true => self.limit(state).unwrap_or_else(|reason| self.stop(reason)),
        }
        for (finger, velocity) in self.fingers.iter().zip(command.admitted_mut()) {
            *velocity = finger.admitted.joint_velocity;
        }
    }

    fn limit(&mut self, state: &HandState) -> Result<(), StopReason> {
        let fingers = self.fingers.iter_mut().zip(&self.poses);
        for (index, ((finger, pose), joints)) in fingers.zip(&state.joints).enumerate() {
            let request = Request {
                velocity: finger.velocity,
                position: pose.position,
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
