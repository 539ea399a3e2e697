//! Drives a gripper through the action `control_msgs/ParallelGripperCommand`, whose goals are positions.

use crate::client::Client;
use crate::freshness::lock;
use crate::message::{SendGripperGoal, SendGripperGoalRequest};
use crate::node::Node;
use crate::node_error::NodeError;
use feeler::hand::{HandState, JointVector, LeashedGoal};
use feeler_record::ros::JointState;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use twox_hash::XxHash3_128;

/// Suffix of an action's name that yields its service for goals.
const SEND_GOAL: &str = "/_action/send_goal";

/// Gripper of a ROS 2 graph that moves all fingers with one motor.
#[derive(Debug, Clone, PartialEq)]
pub struct GripperConfig {
    /// Name of its action (`control_msgs/ParallelGripperCommand`), such as `/gripper_controller/gripper_cmd`.
    pub action: String,
    /// Maximum effort of its joint (N or N m), sent with each goal; if `None`, the controller's limit applies.
    pub max_effort: Option<f64>,
    /// Minimum interval between two goals (s of real time).
    pub interval: f64,
    /// Lower and upper limit of its joint (m or rad).
    pub range: (f64, f64),
    /// Speed limit of its joint (m/s or rad/s).
    pub speed: f64,
}

/// Goal position of a gripper, and its background sender. The goal moves at the mean velocity of the fingers, within a
/// maximum distance (leash) of the measured position. Without commands, nothing is sent: the gripper moves to its
/// latest goal and holds it.
pub(crate) struct Gripper {
    goal: LeashedGoal,
    /// `true` after the first command to move, when the goal was set to the measured position.
    is_held: bool,
    /// Stamp of the joint states of the previous command (s), or `None` if it was a stop.
    commanded_at: Option<f64>,
    /// Maximum age of joint states (s, by the graph's clock).
    most_age: f64,
    waiting: Arc<Waiting>,
    thread: Option<JoinHandle<()>>,
}

struct Waiting {
    goal: Mutex<Goal>,
    changed: Condvar,
}

/// Goal to send next, shared with the sending thread.
#[derive(Default)]
struct Goal {
    /// Position (m or rad), and the time at which it expires.
    next: Option<(f64, Instant)>,
    /// Error of the last goal.
    failed: Option<String>,
    is_over: bool,
}

impl Gripper {
    /// Creates a client of the action, and starts the thread that sends goals for the `joint`. A goal that is not
    /// accepted within `patience` is an error.
    ///
    /// # Errors
    /// If the action's name is invalid, the session is closed, or the thread cannot be started.
    pub fn start(
        node: &mut Node,
        config: &GripperConfig,
        joint: &str,
        most_age: f64,
        patience: Duration,
    ) -> Result<Self, NodeError> {
        let client = node.client(&format!("{}{SEND_GOAL}", config.action))?;
        let waiting = Arc::new(Waiting {
            goal: Mutex::new(Goal::default()),
            changed: Condvar::new(),
        });
        let sender = Sender {
            client,
            waiting: Arc::clone(&waiting),
            action: config.action.clone(),
            request: SendGripperGoalRequest {
                command: JointState {
                    name: vec![joint.into()],
                    position: vec![0.0],
                    effort: config.max_effort.into_iter().collect(),
                    ..JointState::default()
                },
                ..SendGripperGoalRequest::default()
            },
            interval: Duration::try_from_secs_f64(config.interval).unwrap_or_default(),
            patience,
        };
        let thread = thread::Builder::new().name("gripper".into());
        Ok(Self {
            goal: LeashedGoal {
                position: 0.0,
                leash: config.speed * most_age,
                limits: config.range,
                speed: config.speed,
            },
            is_held: false,
            commanded_at: None,
            most_age,
            waiting,
            thread: Some(thread.spawn(move || sender.send_all())?),
        })
    }

    /// Moves the goal at the mean of the fingers' `velocities`, based on the joint states `state`, and queues it to be
    /// sent before `until`. Zero velocities stop the gripper: its goal remains unchanged. Neither blocks nor allocates.
    ///
    /// # Errors
    /// If an earlier goal was not accepted.
    pub fn command(
        &mut self,
        velocities: &[JointVector],
        state: &HandState,
        until: Instant,
    ) -> Result<(), String> {
        let velocity = velocities.iter().map(|velocity| velocity[0]).sum::<f64>();
        let velocity = velocity / velocities.len().max(1) as f64;
        let measured = state
            .joints
            .first()
            .map_or(0.0, |joints| joints.position[0]);
        let mut waiting = lock(&self.waiting.goal);
        if velocity == 0.0 {
            self.commanded_at = None;
        } else {
            // Joint states may be missing before the first motion.
            if !std::mem::replace(&mut self.is_held, true) {
                self.goal.hold(measured);
            }
            // Time comes from the data: goals advance neither without new joint states nor by the time of a rest.
            let before = self.commanded_at.replace(state.stamp);
            let elapsed = (state.stamp - before.unwrap_or(state.stamp)).clamp(0.0, self.most_age);
            self.goal.advance(velocity, elapsed, measured);
            waiting.next = Some((self.goal.position, until));
        }
        let failed = waiting.failed.take();
        drop(waiting);
        self.waiting.changed.notify_one();
        failed.map_or(Ok(()), Err)
    }
}

impl Drop for Gripper {
    fn drop(&mut self) {
        lock(&self.waiting.goal).is_over = true;
        self.waiting.changed.notify_one();
        // If the thread panicked, nothing more can be done.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Background sender of goals.
struct Sender {
    client: Client<SendGripperGoal>,
    waiting: Arc<Waiting>,
    action: String,
    /// Reused request.
    request: SendGripperGoalRequest,
    interval: Duration,
    patience: Duration,
}

impl Sender {
    /// Sends the latest goal, one at a time and at most one per interval, until the gripper is dropped.
    fn send_all(mut self) {
        let mut count = 0_u64;
        while let Some((position, until)) = self.next() {
            let started = Instant::now();
            if started <= until {
                count += 1;
                if let Err(why) = self.send(position, count) {
                    lock(&self.waiting.goal).failed = Some(why);
                }
            }
            thread::sleep(self.interval.saturating_sub(started.elapsed()));
        }
    }

    /// Waits for the next goal. Returns `None` if the gripper was dropped.
    fn next(&self) -> Option<(f64, Instant)> {
        let is_idle = |goal: &mut Goal| goal.next.is_none() && !goal.is_over;
        let goal = self
            .waiting
            .changed
            .wait_while(lock(&self.waiting.goal), is_idle);
        let mut goal = goal.unwrap_or_else(PoisonError::into_inner);
        goal.next.take().filter(|_| !goal.is_over)
    }

    fn send(&mut self, position: f64, count: u64) -> Result<(), String> {
        let mut unique = [0; 24];
        unique[..16].copy_from_slice(&self.client.gid());
        unique[16..].copy_from_slice(&count.to_le_bytes());
        self.request.goal_id = XxHash3_128::oneshot(&unique).to_le_bytes();
        self.request.command.position[0] = position;
        let action = &self.action;
        match self.client.call(&self.request, self.patience) {
            Ok(response) if response.accepted => Ok(()),
            Ok(_) => Err(format!(
                "{action}: the gripper rejected a goal at {position:.4}"
            )),
            Err(error) => Err(format!("{action}: {error}")),
        }
    }
}
