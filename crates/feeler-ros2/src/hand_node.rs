//! Publishers of a hand's node.

use crate::hand_messages::{FingerMessages, HandMessages};
use crate::message::{Clock, DiagnosticArray, DiagnosticStatus, TactileState};
use crate::node::Node;
use crate::node_error::NodeError;
use crate::publisher::Publisher;
use crate::qos::{History, Qos};
use feeler_record::ros::{Header, JointState, PointCloud2, TFMessage, Text, Time, WrenchStamped};
use feeler_record::tactile_array::TactileArray;

/// Publishers of a hand's joints, tactile state and diagnostics.
pub struct HandPublishers {
    description: Publisher<Text>,
    still: Publisher<TFMessage>,
    moving: Publisher<TFMessage>,
    joints: Publisher<JointState>,
    diagnostics: Publisher<DiagnosticArray>,
    clock: Option<Publisher<Clock>>,
    fingers: Vec<FingerPublishers>,
}

struct FingerPublishers {
    wrench: Publisher<WrenchStamped>,
    taxels: Publisher<PointCloud2>,
    tactile: Publisher<TactileState>,
    array: Publisher<TactileArray>,
}

impl HandPublishers {
    /// Creates the publishers of a hand with this number of `fingers`. If `clock` is `true`, also publishes the hand's
    /// time on `/clock`, for nodes with `use_sim_time`.
    ///
    /// # Errors
    /// If the node's session is closed.
    pub fn new(node: &mut Node, fingers: usize, clock: bool) -> Result<Self, NodeError> {
        let of_frames = Qos {
            history: History::KeepLast(100),
            ..Qos::DEFAULT
        };
        let mut finger = |number: usize| {
            let topic = |name| format!("finger_{number}/{name}");
            Ok(FingerPublishers {
                wrench: node.publish(&topic("wrench"), Qos::DEFAULT)?,
                taxels: node.publish(&topic("taxels"), Qos::DEFAULT)?,
                tactile: node.publish(&topic("tactile"), Qos::DEFAULT)?,
                array: node.publish(&topic("tactile_array"), Qos::DEFAULT)?,
            })
        };
        let fingers = (0..fingers)
            .map(&mut finger)
            .collect::<Result<_, NodeError>>()?;
        Ok(Self {
            description: node.publish("robot_description", Qos::LATCHED)?,
            still: node.publish("/tf_static", Qos::LATCHED)?,
            moving: node.publish("/tf", of_frames)?,
            joints: node.publish("joint_states", Qos::DEFAULT)?,
            diagnostics: node.publish("/diagnostics", Qos::DEFAULT)?,
            clock: match clock {
                true => Some(node.publish("/clock", Qos::DEFAULT)?),
                false => None,
            },
            fingers,
        })
    }

    /// Publishes the robot description and the fixed transforms. Late subscribers also receive them.
    ///
    /// # Errors
    /// If the session is closed.
    pub fn publish_still(&mut self, messages: &HandMessages) -> Result<(), NodeError> {
        self.description.publish(&messages.kinematics.description)?;
        self.still.publish(&messages.kinematics.still)
    }

    /// Publishes the joints, the transforms of moving frames and, if enabled, the clock.
    ///
    /// # Errors
    /// If the session is closed.
    pub fn publish_joints(&mut self, messages: &HandMessages) -> Result<(), NodeError> {
        if let Some(clock) = &mut self.clock {
            clock.publish(&Clock {
                clock: messages.kinematics.joints.header.stamp,
            })?;
        }
        self.joints.publish(&messages.kinematics.joints)?;
        self.moving.publish(&messages.kinematics.moving)
    }

    /// Publishes the tactile state of `finger`. Does nothing if there is no such finger.
    ///
    /// # Errors
    /// If the session is closed.
    pub fn publish_finger(
        &mut self,
        finger: usize,
        messages: &FingerMessages,
    ) -> Result<(), NodeError> {
        let Some(publishers) = self.fingers.get_mut(finger) else {
            return Ok(());
        };
        publishers.wrench.publish(&messages.wrench)?;
        publishers.taxels.publish(&messages.taxels)?;
        publishers.tactile.publish(&messages.tactile)?;
        publishers.array.publish(&messages.array)
    }

    /// Publishes the diagnostics of all parts of the hand.
    ///
    /// # Errors
    /// If the session is closed.
    pub fn publish_diagnostics(
        &mut self,
        stamp: Time,
        status: Vec<DiagnosticStatus>,
    ) -> Result<(), NodeError> {
        let header = Header {
            stamp,
            ..Header::default()
        };
        self.diagnostics
            .publish(&DiagnosticArray { header, status })
    }
}
