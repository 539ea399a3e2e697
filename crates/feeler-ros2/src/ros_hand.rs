//! Another maker's robot as a hand: its joints from `sensor_msgs/JointState`, velocities to a `forward_command_controller`.

use crate::freshness::{Freshness, GraphClock, lock, seconds};
use crate::joint_reader::{JointError, JointNames, JointReader};
use crate::message::Float64MultiArray;
use crate::node::{Node, NodeError, Subscription};
use crate::publisher::Publisher;
use crate::qos::Qos;
use feeler::hand::{Hand, HandCommand, HandError, HandState, check_finger_count};
use feeler_record::ros::JointState;
use feeler_record::wire::cdr;
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// Where a robot's joints are and where its velocities go.
#[derive(Debug, Clone, PartialEq)]
pub struct RosHandConfig {
    /// Names of the joints theta1..theta3 of each finger, in the order in which the controller has them.
    pub joints: JointNames,
    /// Topic of the joint states, as in `/joint_states`.
    pub joint_states: String,
    /// Topic of the controller's commands, as in `/forward_velocity_controller/commands`.
    pub commands: String,
    /// How old joint states may be, s.
    pub most_age: f64,
}

/// A robot of a ROS 2 graph as a [`Hand`]. Reading takes the newest joint states that are there, and never waits. Time is that of their
/// stamps.
///
/// A `forward_command_controller` does what it was told last until it is told otherwise: if this program is killed or the network fails, only
/// the robot's own watchdog stops it. Where this is dropped, it sends zeros.
pub struct RosHand {
    newest: Arc<Mutex<Newest>>,
    freshness: Freshness,
    commands: Publisher<Float64MultiArray>,
    message: Float64MultiArray,
    fingers: usize,
    _subscription: Subscription,
}

/// What was heard last.
struct Newest {
    reader: JointReader,
    state: HandState,
    /// When it arrived; none before the first.
    arrived: Option<Instant>,
    /// Why it is of no use.
    error: Option<JointError>,
}

impl Newest {
    /// Takes in a message's bytes. What is no such message, or is not newer, is left.
    fn take(&mut self, bytes: &[u8]) {
        let Ok(message) = cdr::decode::<JointState>(bytes) else {
            return;
        };
        let stamp = seconds(message.header.stamp);
        if self.arrived.is_some() && stamp <= self.state.stamp {
            return;
        }
        // Others may publish other joints under the same topic.
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

/// Why a robot cannot be a hand.
#[derive(Debug, thiserror::Error)]
pub enum RosHandError {
    /// The node cannot do it.
    #[error(transparent)]
    Node(#[from] NodeError),
    /// Its joints make no sense.
    #[error(transparent)]
    Joints(#[from] JointError),
}

impl RosHand {
    /// Begins to listen to the robot, whose time is that of `clock`. Nothing moves.
    ///
    /// # Errors
    /// When the configuration makes no sense, or the node's session is closed.
    pub fn new(
        node: &mut Node,
        config: RosHandConfig,
        clock: GraphClock,
    ) -> Result<Self, RosHandError> {
        let reader = JointReader::new(config.joints)?;
        let fingers = reader.finger_count();
        let newest = Arc::new(Mutex::new(Newest {
            reader,
            state: HandState::zero(fingers),
            arrived: None,
            error: None,
        }));
        let heard = Arc::clone(&newest);
        let take = move |bytes: &[u8], _| lock(&heard).take(bytes);
        Ok(Self {
            newest,
            _subscription: node.subscribe::<JointState>(
                &config.joint_states,
                Qos::SENSOR_DATA,
                take,
            )?,
            freshness: Freshness {
                topic: config.joint_states,
                clock,
                most: config.most_age,
            },
            commands: node.publish(&config.commands, Qos::DEFAULT)?,
            message: Float64MultiArray {
                data: vec![0.0; 3 * fingers],
                ..Float64MultiArray::default()
            },
            fingers,
        })
    }

    fn send(&mut self) -> Result<(), HandError> {
        let sent = self.commands.publish(&self.message);
        sent.map_err(|e| HandError::Failed(e.to_string()))
    }
}

impl Hand for RosHand {
    fn finger_count(&self) -> usize {
        self.fingers
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        check_finger_count(self.fingers, state.joints.len())?;
        let newest = lock(&self.newest);
        let (stamp, arrived) = (newest.state.stamp, newest.arrived);
        let fresh = self.freshness.check(stamp, arrived, newest.error.as_ref());
        fresh.map_err(HandError::Failed)?;
        state.stamp = newest.state.stamp;
        state.joints.copy_from_slice(&newest.state.joints);
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        check_finger_count(self.fingers, command.joint_velocity().len())?;
        let velocities = command.joint_velocity().iter().flat_map(|v| v.to_array());
        for (out, velocity) in self.message.data.iter_mut().zip(velocities) {
            *out = velocity;
        }
        self.send()
    }
}

impl Drop for RosHand {
    fn drop(&mut self) {
        self.message.data.fill(0.0);
        // Where the network is gone, nothing more can be done from here.
        let _ = self.send();
    }
}
