//! Another maker's robot as a hand: its joints from `sensor_msgs/JointState`, velocities to a `forward_command_controller`.

use crate::freshness::{Freshness, GraphClock, StaleError, lock, seconds};
use crate::joint_reader::{JointError, JointNames, JointReader};
use crate::node::{Node, NodeError, Subscription};
use crate::qos::Qos;
use crate::velocity_sender::VelocitySender;
use feeler::hand::{Hand, HandCommand, HandError, HandState, check_finger_count};
use feeler_record::ros::JointState;
use feeler_record::wire::cdr;
use glam::DVec3;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Where a robot's joints are and where its velocities go.
#[derive(Debug, Clone, PartialEq)]
pub struct RosHandConfig {
    /// Names of the joints theta1..theta3 of each finger, in the order in which the controller has them.
    pub joints: JointNames,
    /// Topic of the joint states, as in `/joint_states`.
    pub joint_states: String,
    /// Topic of the controller's commands, as in `/forward_velocity_controller/commands`.
    pub commands: String,
    /// How old joint states may be, s of the graph's time.
    pub most_age: f64,
    /// Seconds of the graph's time in a second: 1 unless it is a simulation's.
    pub speed: f64,
}

/// A robot of a ROS 2 graph as a [`Hand`]. Reading takes the newest joint states that are there, and never waits. Time is that of their
/// stamps. Velocities are sent by a thread of its own, so that commanding neither waits nor allocates; of several that wait only the newest.
///
/// No velocity is sent while joint states are older than they may be, or that was commanded longer ago. A `forward_command_controller` does
/// what it was told last until it is told otherwise, so zeros are sent instead, and where this is dropped. If the program is killed or the
/// network fails, only the robot's own watchdog stops it.
pub struct RosHand {
    newest: Arc<Mutex<Newest>>,
    freshness: Arc<Freshness>,
    commands: VelocitySender,
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
    /// Takes in a message's bytes. What is no such message, or is no news, is left.
    fn take(&mut self, bytes: &[u8], freshness: &Freshness) {
        let Ok(message) = cdr::decode::<JointState>(bytes) else {
            return;
        };
        let stamp = seconds(message.header.stamp);
        if !freshness.is_news(stamp, self.state.stamp, self.arrived) {
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
        let commands = node.publish(&config.commands, Qos::DEFAULT)?;
        // What is no time at all lets nothing move.
        let most = Duration::try_from_secs_f64(config.most_age / config.speed).unwrap_or_default();
        Ok(Self {
            newest,
            freshness,
            commands: VelocitySender::start(commands, 3 * fingers, most)
                .map_err(NodeError::from)?,
            fingers,
            _subscription: subscription,
        })
    }

    /// What time it is in the graph, s.
    ///
    /// # Errors
    /// When no `/clock` was heard yet.
    pub fn now(&self) -> Result<f64, StaleError> {
        self.freshness.clock.now()
    }

    /// How old the `newest` joint states are, s of the graph's time, if they are fresh.
    fn age(&self, newest: &Newest) -> Result<f64, HandError> {
        let (stamp, arrived) = (newest.state.stamp, newest.arrived);
        let fresh = self.freshness.check(stamp, arrived, newest.error.as_ref());
        fresh.map_err(HandError::Failed)
    }

    /// Until when what is commanded now may be sent.
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
        self.fingers
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        check_finger_count(self.fingers, state.joints.len())?;
        let newest = lock(&self.newest);
        self.age(&newest)?;
        state.stamp = newest.state.stamp;
        state.joints.copy_from_slice(&newest.state.joints);
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        let velocities = command.joint_velocity();
        check_finger_count(self.fingers, velocities.len())?;
        let moves = velocities.iter().any(|velocity| *velocity != DVec3::ZERO);
        let expiry = match moves {
            true => self.expiry(),
            false => Ok(Instant::now()),
        };
        // From stale joint states nothing moves, and what moves is stopped.
        let scale = if expiry.is_ok() { 1.0 } else { 0.0 };
        let values = velocities.iter().flat_map(|v| (scale * v).to_array());
        let until = *expiry.as_ref().unwrap_or(&Instant::now());
        let given = self.commands.give(values, until);
        expiry.map(drop).and(given.map_err(HandError::Failed))
    }
}
