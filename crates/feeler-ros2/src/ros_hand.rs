//! Uses a ROS 2 robot as a hand: reads joints from `sensor_msgs/JointState`, and sends velocities to a
//! `forward_command_controller` or goals to a gripper's action.

use crate::freshness::{Freshness, GraphClock, StaleError, lock, seconds};
use crate::gripper::{Gripper, GripperConfig};
use crate::joint_reader::{JointError, JointNames, JointReader};
use crate::node::{Node, Subscription};
use crate::node_error::NodeError;
use crate::qos::Qos;
use crate::velocity_sender::VelocitySender;
use feeler::hand::{Hand, HandCommand, HandError, HandState, JointVector, check_finger_count};
use feeler_record::ros::JointState;
use feeler_record::wire::cdr;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Joints and topics of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RosHandConfig {
    /// Names of the joints of each finger, from the base to the fingertip, in the controller's order.
    pub joints: JointNames,
    /// Topic of the joint states, such as `/joint_states`.
    pub joint_states: String,
    /// Interface that moves the joints.
    pub commands: RosCommands,
    /// Maximum age of joint states (s, by the graph's clock).
    pub most_age: f64,
    /// Speed of `clock` relative to real time; 1 unless simulated.
    pub speed: f64,
}

/// Interface that moves the joints of a robot.
#[derive(Debug, Clone, PartialEq)]
pub enum RosCommands {
    /// Velocities, sent on this topic of a `forward_command_controller`, such as
    /// `/forward_velocity_controller/commands`.
    Velocities(String),
    /// Goals for the joint of the first finger, whose motor moves all fingers. Each finger has one joint.
    Gripper(GripperConfig),
}

/// Sender of commands.
enum Drive {
    Velocities(VelocitySender),
    Gripper(Gripper),
}

/// [`Hand`] that controls a ROS 2 robot.
///
/// Reading returns the latest joint states and their stamp, without waiting. A background thread sends the latest
/// command, so commanding neither blocks nor allocates.
///
/// A `forward_command_controller` executes the last velocities until it receives others. Zeros are therefore sent if
/// joint states or commands are too old, and when the hand is dropped. If the program is killed or the network fails,
/// only a watchdog in the robot can stop it. A gripper instead moves to its latest goal. The distance to the goal is
/// limited to the travel at the gripper's speed limit within the maximum age of joint states.
pub struct RosHand {
    newest: Arc<Mutex<Newest>>,
    freshness: Arc<Freshness>,
    drive: Drive,
    /// Number of joints of each finger.
    joints: Vec<usize>,
    _subscription: Subscription,
}

/// Latest joint states.
struct Newest {
    reader: JointReader,
    state: HandState,
    /// Time of arrival, or `None` before the first message.
    arrived: Option<Instant>,
    /// Error in the latest message, if any.
    error: Option<JointError>,
}

impl Newest {
    /// Updates the state from the bytes of a message. Ignores undecodable and outdated messages.
    fn take(&mut self, bytes: &[u8], freshness: &Freshness) {
        let Ok(message) = cdr::decode::<JointState>(bytes) else {
            return;
        };
        let stamp = seconds(message.header.stamp);
        if !freshness.is_news(stamp, self.state.stamp, self.arrived) {
            return;
        }
        // Other nodes may publish other joints on the same topic.
        match self.reader.read(&message, &mut self.state) {
            Err(JointError::Missing(_)) if self.arrived.is_some() => {}
            other => {
                self.error = other.err();
                self.state.stamp = stamp;
                self.arrived = Some(Instant::now());
            }
        }
    }
}

/// Error when creating a [`RosHand`].
#[derive(Debug, thiserror::Error)]
pub enum RosHandError {
    /// The node returned an error.
    #[error(transparent)]
    Node(#[from] NodeError),
    /// The joints are invalid.
    #[error(transparent)]
    Joints(#[from] JointError),
    /// A finger of a gripper has several joints.
    #[error(
        "expected one joint of finger {finger}, as a gripper's action moves one joint, got {actual}"
    )]
    GripperJoints {
        /// Index of the finger.
        finger: usize,
        /// Number of joints of the finger.
        actual: usize,
    },
}

impl RosHand {
    /// Subscribes to the robot's joint states, whose stamps are in the time of `clock`. Does not move the robot.
    ///
    /// # Errors
    /// If the configuration is invalid, or the node's session is closed.
    pub fn new(
        node: &mut Node,
        config: RosHandConfig,
        clock: GraphClock,
    ) -> Result<Self, RosHandError> {
        let first = config.joints.iter().flatten().next().cloned();
        let reader = JointReader::new(config.joints)?;
        let joints = reader.joint_counts();
        let newest = Arc::new(Mutex::new(Newest {
            reader,
            state: HandState::zero(joints.len()),
            arrived: None,
            error: None,
        }));
        let freshness = Arc::new(Freshness {
            topic: config.joint_states,
            clock,
            most: config.most_age,
            speed: config.speed,
        });
        let (heard, judge) = (Arc::clone(&newest), Arc::clone(&freshness));
        let take = move |bytes: &[u8], _| lock(&heard).take(bytes, &judge);
        let subscription =
            node.subscribe::<JointState>(&freshness.topic, Qos::SENSOR_DATA, take)?;
        // An invalid limit becomes zero, so that velocities expire at once.
        let most = Duration::try_from_secs_f64(config.most_age / config.speed).unwrap_or_default();
        let drive = match &config.commands {
            RosCommands::Velocities(topic) => {
                let topic = node.publish(topic, Qos::DEFAULT)?;
                let sender = VelocitySender::start(topic, joints.iter().sum(), most);
                Drive::Velocities(sender.map_err(NodeError::from)?)
            }
            RosCommands::Gripper(gripper) => {
                if let Some(finger) = joints.iter().position(|&joints| joints != 1) {
                    return Err(RosHandError::GripperJoints {
                        finger,
                        actual: joints[finger],
                    });
                }
                let first = first.unwrap_or_default();
                let most_age = config.most_age;
                Drive::Gripper(Gripper::start(node, gripper, &first, most_age, most)?)
            }
        };
        Ok(Self {
            newest,
            freshness,
            drive,
            joints,
            _subscription: subscription,
        })
    }

    /// Returns the current time of the graph (s).
    ///
    /// # Errors
    /// If the clock is simulated and no message on `/clock` has arrived yet.
    pub fn now(&self) -> Result<f64, StaleError> {
        self.freshness.clock.now()
    }

    /// Returns the age of the joint states (s, by the graph's clock), or an error if they are too old or invalid.
    fn age(&self, newest: &Newest) -> Result<f64, HandError> {
        let (stamp, arrived) = (newest.state.stamp, newest.arrived);
        let fresh = self.freshness.check(stamp, arrived, newest.error.as_ref());
        fresh.map_err(HandError::Failed)
    }

    /// Returns the time at which a command computed from the latest joint states expires.
    fn expiry(&self) -> Result<Instant, HandError> {
        let age = self.age(&lock(&self.newest))?;
        let Freshness { most, speed, .. } = *self.freshness;
        let left = Duration::try_from_secs_f64((most - age) / speed).unwrap_or_default();
        let now = Instant::now();
        Ok(now.checked_add(left).unwrap_or(now))
    }
}

impl Hand for RosHand {
    fn finger_count(&self) -> usize {
        self.joints.len()
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        check_finger_count(self.joints.len(), state.joints.len())?;
        let newest = lock(&self.newest);
        self.age(&newest)?;
        state.stamp = newest.state.stamp;
        state.joints.copy_from_slice(&newest.state.joints);
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        let velocities = command.joint_velocity();
        check_finger_count(self.joints.len(), velocities.len())?;
        for (&expected, velocity) in self.joints.iter().zip(velocities) {
            let actual = velocity.len();
            if actual > expected {
                return Err(HandError::JointCount { expected, actual });
            }
        }
        let stopped = JointVector::default();
        let moves = velocities.iter().any(|velocity| *velocity != stopped);
        let expiry = match moves {
            true => self.expiry(),
            false => Ok(Instant::now()),
        };
        let until = *expiry.as_ref().unwrap_or(&Instant::now());
        let given = match &mut self.drive {
            Drive::Velocities(sender) => {
                // Stale joint states stop the robot.
                let scale = if expiry.is_ok() { 1.0 } else { 0.0 };
                // Missing velocities are 0.
                let fingers = self.joints.iter().zip(velocities);
                let numbers = fingers.flat_map(|(&joints, velocity)| velocity.padded(joints));
                sender.give(numbers.map(|velocity| scale * velocity), until)
            }
            // A gripper keeps its goal if joint states are stale.
            Drive::Gripper(gripper) if expiry.is_ok() => {
                gripper.command(velocities, &lock(&self.newest).state, until)
            }
            Drive::Gripper(_) => Ok(()),
        };
        expiry.map(drop).and(given.map_err(HandError::Failed))
    }
}
