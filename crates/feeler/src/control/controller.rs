//! Controller of a hand: computes joint velocities from tactile frames and joint angles.

pub use super::config::{ControlConfig, RecordingFailure, ResumePolicy};

use super::input_check::{check_count, check_input, check_load};
use super::limits::{LimitedCommand, Request};
use super::monitor::{EffortMonitor, ExpectedEfforts, JointMonitor, StuckSensorDetector};
use super::phase::Phase;
use super::plan::Plan;
use super::sense::{FingertipPose, HandReadings};
use super::stop_reason::StopReason;
use super::touch::TactileReading;
use crate::control::law::{FingerLaws, HandLaw, Law, LawError};
use crate::control::task::{Task, TaskConfig};
use crate::hand::geometry::FingerGeometry;
use crate::hand::kinematics::fingertip_pose;
use crate::hand::{HandCommand, HandState, JointCoupling};
use crate::sensor::fingertip::layout::ElementLayout;
use glam::DVec3;

/// State of one finger in the controller.
#[derive(Debug, Clone)]
pub struct FingerControl {
    geometry: FingerGeometry,
    /// Fingertip velocity requested by the law or an external policy (m/s, in W).
    pub velocity: DVec3,
    /// Joint velocities after limiting.
    pub admitted: LimitedCommand,
    joint_monitor: JointMonitor,
    stuck_sensor: StuckSensorDetector,
    effort_monitor: EffortMonitor,
}

impl FingerControl {
    /// Geometry and joint limits of the finger.
    pub fn geometry(&self) -> &FingerGeometry {
        &self.geometry
    }
}

/// Runs the task, the control law, the limits and the monitors of a hand.
#[derive(Debug, Clone)]
pub struct Controller {
    config: ControlConfig,
    fingers: Vec<FingerControl>,
    poses: Vec<FingertipPose>,
    layouts: Vec<ElementLayout>,
    couplings: Vec<JointCoupling>,
    task: Box<dyn Task>,
    law: Box<dyn HandLaw>,
    /// `true` for each finger that the law considers closed on the object; see [`HandReadings::closed`].
    closed: Vec<Option<bool>>,
    /// Fingertip velocities computed by the law (m/s, in W).
    velocities: Vec<DVec3>,
    /// The task's plan for each finger.
    plans: Vec<Plan>,
    /// `true` if the latest input was valid and no command has been derived from it yet.
    planned: bool,
    stop_reason: Option<StopReason>,
}

impl Controller {
    /// Creates a controller for a hand with the given `fingers` and the element layout of each.
    ///
    /// # Errors
    /// If the law is a policy that has not been loaded, or was made for other fingertips or numbers of joints.
    pub fn new(
        config: ControlConfig,
        task: &TaskConfig,
        fingers: &[FingerGeometry],
        layouts: &[ElementLayout],
    ) -> Result<Self, LawError> {
        Self::with_task(config, task.task(), fingers, layouts)
    }

    /// Like [`new`](Self::new), but with a custom task.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_task(
        config: ControlConfig,
        task: Box<dyn Task>,
        fingers: &[FingerGeometry],
        layouts: &[ElementLayout],
    ) -> Result<Self, LawError> {
        config.law.check_joints(fingers)?;
        let most_gap = config.stale_periods.max(1.5) * config.period;
        let finger = |(geometry, layout): (&FingerGeometry, &ElementLayout)| {
            let elements = layout.elements.len();
            FingerControl {
                geometry: geometry.clone(),
                velocity: DVec3::ZERO,
                admitted: LimitedCommand::default(),
                joint_monitor: JointMonitor::new(config.monitor, most_gap),
                stuck_sensor: StuckSensorDetector::new(config.monitor.frozen_frames, elements),
                effort_monitor: EffortMonitor::new(config.monitor, most_gap),
            }
        };
        let fingers: Vec<_> = fingers.iter().zip(layouts).map(finger).collect();
        let count = fingers.len();
        Ok(Self {
            fingers,
            poses: vec![FingertipPose::default(); count],
            layouts: layouts[..count].to_vec(),
            couplings: Vec::new(),
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

    /// State of each finger after the latest decision.
    pub fn fingers(&self) -> &[FingerControl] {
        &self.fingers
    }

    /// Replaces the law of each finger by `law(finger)`, where `finger` is the finger's index.
    pub fn set_laws(&mut self, law: impl Fn(usize) -> Box<dyn Law>) {
        let laws = (0..self.fingers.len()).map(law).collect();
        self.law = Box::new(FingerLaws::new(laws));
    }

    /// Sets the joints that are moved together with joints of other fingers; by default, each joint has its own motor.
    pub fn set_couplings(&mut self, couplings: Vec<JointCoupling>) {
        self.couplings = couplings;
    }

    /// Fingertip poses computed from the joint angles, as of the latest decision.
    pub fn poses(&self) -> &[FingertipPose] {
        &self.poses
    }

    /// The task, in its state after the latest decision.
    pub fn task(&self) -> &dyn Task {
        &*self.task
    }

    /// Phase of the task, or [`Phase::Stopped`] while the hand is stopped.
    pub fn phase(&self) -> Phase {
        match self.stop_reason {
            Some(_) => Phase::Stopped,
            None => self.task.phase(),
        }
    }

    /// Reason of the stop, or `None` while the hand is not stopped.
    pub fn stop_reason(&self) -> Option<&StopReason> {
        self.stop_reason.as_ref()
    }

    /// The task's plan for each finger, as of the latest decision. All plans are at rest while the hand is stopped.
    pub fn plans(&self) -> &[Plan] {
        &self.plans
    }

    /// Combines the given readings with the poses and layouts of the latest decision.
    pub fn hand_sense<'a>(
        &'a self,
        touches: &'a [TactileReading],
        state: &'a HandState,
    ) -> HandReadings<'a> {
        HandReadings {
            closed: &self.closed,
            ..HandReadings::new(state, touches, &self.poses, &self.layouts)
        }
    }

    /// Computes the joint velocities of all fingers for the next control period from tactile readings and the joint
    /// state. Does not allocate. A fault in the input stops all fingers with a [`StopReason`].
    pub fn decide(
        &mut self,
        touches: &[TactileReading],
        state: &HandState,
        command: &mut HandCommand,
    ) {
        self.plan(touches, state);
        self.act_with_laws(touches, state, command);
    }

    /// First half of [`decide`](Self::decide): checks the input and updates the task's [`plans`](Self::plans). Must be
    /// followed by [`act_with_laws`](Self::act_with_laws), or by [`follow`](Self::follow) to replace the laws.
    pub fn plan(&mut self, touches: &[TactileReading], state: &HandState) {
        let planned = self
            .feel(touches, state)
            .and_then(|()| self.watch(touches, state))
            .and_then(|()| self.ask_task(touches, state));
        self.planned = planned.is_ok();
        if let Err(reason) = planned {
            self.stop(reason);
        }
    }

    /// Second half of [`decide`](Self::decide), after [`plan`](Self::plan): applies the control laws and limits.
    pub fn act_with_laws(
        &mut self,
        touches: &[TactileReading],
        state: &HandState,
        command: &mut HandCommand,
    ) {
        if self.planned {
            self.obey_laws(touches, state);
        }
        self.apply_limits(state, command);
    }

    /// Second half of [`decide`](Self::decide), after [`plan`](Self::plan), using the given fingertip velocities (m/s,
    /// in W) instead of those of the control laws. The same limits apply. A missing or non-finite velocity stops all
    /// fingers with a [`StopReason`]. Nothing moves while the hand is stopped, or without a new plan.
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
        self.apply_limits(state, command);
    }

    /// Stops all fingers immediately, until [`resume`](Self::resume) is called. The first reason is kept, with one
    /// exception: a requested stop replaces a stop caused by stale data, because the latter may end automatically and a
    /// requested one must not.
    pub fn stop(&mut self, reason: StopReason) {
        let told = matches!(reason, StopReason::Requested { .. });
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
            finger.admitted = LimitedCommand::default();
        }
    }

    /// Resumes motion after a stop. If the cause persists, the next decision stops the hand again. The monitors are
    /// reset, because the fingers may have been moved during the stop.
    pub fn resume(&mut self) {
        if self.stop_reason.take().is_some() {
            for finger in &mut self.fingers {
                finger.joint_monitor.reset();
                finger.stuck_sensor.reset();
                finger.effort_monitor.reset();
            }
        }
    }

    /// Checks the input and updates the fingertip poses.
    fn feel(&mut self, touches: &[TactileReading], state: &HandState) -> Result<(), StopReason> {
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
            let (elements, joint_count) = (layout.elements.len(), geometry.joint_count());
            check_input(finger, elements, joint_count, touch, joints)?;
            let age = state.stamp - touch.stamp;
            // Also rejects a NaN age, and forces with a stamp in the future.
            if age.is_nan() || age.abs() > limit {
                return Err(StopReason::StaleForces { finger, age, limit });
            }
            check_load(finger, touch, self.config.limits.element_force)?;
            (pose.position, pose.rotation) = fingertip_pose(geometry, joints.position);
        }
        Ok(())
    }

    /// Checks the plausibility of the sensor readings while the hand moves.
    fn watch(&mut self, touches: &[TactileReading], state: &HandState) -> Result<(), StopReason> {
        if self.stop_reason.is_some() {
            return Ok(());
        }
        for (index, (touch, joints)) in touches.iter().zip(&state.joints).enumerate() {
            let felt = self.felt_efforts(index, touches, state);
            let Some(finger) = self.fingers.get_mut(index) else {
                break;
            };
            let (geometry, stamp) = (&finger.geometry, state.stamp);
            let command = finger.admitted.joint_velocity;
            let joint_monitor = &mut finger.joint_monitor;
            joint_monitor
                .watch(index, geometry, stamp, joints.position, command)
                .map_err(|reason| reason.with_couplings(&self.couplings))?;
            finger.stuck_sensor.watch(index, touch)?;
            if let (Some(felt), Some(efforts)) = (felt, state.efforts.get(index)) {
                let monitor = &mut finger.effort_monitor;
                monitor.watch(index, geometry, stamp, joints, efforts, felt)?;
            }
        }
        Ok(())
    }

    /// Efforts of the motors of finger `index` that balance all measured forces, or `None` if its efforts are not compared.
    fn felt_efforts(
        &self,
        index: usize,
        touches: &[TactileReading],
        state: &HandState,
    ) -> Option<ExpectedEfforts> {
        let monitor = &self.fingers.get(index)?.effort_monitor;
        let efforts = state.efforts.get(index)?;
        if !monitor.is_comparable(efforts) {
            return None;
        }
        let felt = |finger: usize| {
            let (own, pose) = (self.fingers.get(finger)?, self.poses.get(finger)?);
            let frame = &touches.get(finger)?.frame;
            let force = pose.rotation * frame.resultant(self.layouts.get(finger)?);
            Some(ExpectedEfforts::of(
                &own.geometry,
                state.joints.get(finger)?,
                force,
            ))
        };
        let mut sum = felt(index)?;
        for coupling in &self.couplings {
            let ((first, joint), (other, moved)) = (coupling.first, coupling.other);
            if first == index {
                sum.add(joint, coupling.ratio * felt(other)?.efforts[moved]);
            }
        }
        Some(sum)
    }

    /// Advances the task and updates its plan for each finger.
    fn ask_task(
        &mut self,
        touches: &[TactileReading],
        state: &HandState,
    ) -> Result<(), StopReason> {
        if self.stop_reason.is_some() {
            return Ok(());
        }
        let hand = HandReadings::new(state, touches, &self.poses, &self.layouts);
        self.law.observe(&hand, &mut self.closed);
        let hand = HandReadings {
            closed: &self.closed,
            ..hand
        };
        self.task.advance(&hand)?;
        for (finger, plan) in self.plans.iter_mut().enumerate() {
            *plan = self.task.plan(finger, &hand);
        }
        Ok(())
    }

    /// Computes the velocity of each finger with the control law.
    fn obey_laws(&mut self, touches: &[TactileReading], state: &HandState) {
        let hand = HandReadings::new(state, touches, &self.poses, &self.layouts);
        self.law
            .velocities(&self.plans, &hand, &mut self.velocities);
        for (finger, &velocity) in self.fingers.iter_mut().zip(&self.velocities) {
            finger.velocity = velocity;
        }
    }

    /// Creates the command by limiting the velocity of each finger, once per plan.
    fn apply_limits(&mut self, state: &HandState, command: &mut HandCommand) {
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
                .apply_limits(&finger.geometry, &request, self.config.period)
                .ok_or(StopReason::NotFinite {
                    finger: index,
                    what: "command",
                })?;
        }
        Ok(())
    }
}
