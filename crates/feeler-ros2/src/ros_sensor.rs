//! Another maker's sensor as a fingertip: forces from `geometry_msgs/WrenchStamped` or `sensor_msgs/PointCloud2`.

use crate::cloud::{CloudError, read_forces};
use crate::freshness::{Freshness, GraphClock, lock, seconds};
use crate::node::{Node, NodeError, Subscription};
use crate::qos::Qos;
use feeler::sensor::reading::{SensorError, TactileFrame, TactileSensor};
use feeler_record::ros::{PointCloud2, Time, WrenchStamped};
use feeler_record::wire::{Message, cdr};
use glam::DVec3;
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// A sensor of a ROS 2 graph as a [`TactileSensor`]. Reading takes the newest forces that are there, and never waits. Time is that of their
/// stamps.
pub struct RosSensor {
    newest: Arc<Mutex<Newest>>,
    freshness: Freshness,
    elements: usize,
    _subscription: Subscription,
}

/// What was heard last.
struct Newest {
    frame: TactileFrame,
    /// When it arrived; none before the first.
    arrived: Option<Instant>,
    /// Why it is of no use.
    error: Option<CloudError>,
}

impl RosSensor {
    /// A fingertip of one element, from the wrench under `topic`: the force on the fingertip by what it touches, N, in a frame whose z axis
    /// points outward. Data older than `most_age`, s, are refused.
    ///
    /// # Errors
    /// When there can be no such topic, or the node's session is closed.
    pub fn wrench(
        node: &mut Node,
        topic: &str,
        most_age: f64,
        clock: GraphClock,
    ) -> Result<Self, NodeError> {
        let read = |message: &WrenchStamped, forces: &mut [DVec3]| {
            let force = DVec3::from(message.wrench.force);
            // Compression is positive along the inward normal.
            forces.fill(force.with_z(-force.z));
            Ok(())
        };
        let stamp = |message: &WrenchStamped| message.header.stamp;
        Self::listen(node, topic, 1, (most_age, clock), stamp, read)
    }

    /// A fingertip of so many `elements`, from the cloud under `topic`, as [`read_forces`] reads it.
    ///
    /// # Errors
    /// As [`wrench`](Self::wrench).
    pub fn cloud(
        node: &mut Node,
        topic: &str,
        elements: usize,
        most_age: f64,
        clock: GraphClock,
    ) -> Result<Self, NodeError> {
        let stamp = |message: &PointCloud2| message.header.stamp;
        Self::listen(node, topic, elements, (most_age, clock), stamp, read_forces)
    }

    fn listen<M: Message + 'static>(
        node: &mut Node,
        topic: &str,
        elements: usize,
        (most, clock): (f64, GraphClock),
        stamp: fn(&M) -> Time,
        read: fn(&M, &mut [DVec3]) -> Result<(), CloudError>,
    ) -> Result<Self, NodeError> {
        let newest = Arc::new(Mutex::new(Newest {
            frame: TactileFrame::unloaded(elements),
            arrived: None,
            error: None,
        }));
        let heard = Arc::clone(&newest);
        let take = move |bytes: &[u8], _| {
            let Ok(message) = cdr::decode::<M>(bytes) else {
                return;
            };
            let (mut newest, stamp) = (lock(&heard), seconds(stamp(&message)));
            if newest.arrived.is_some() && stamp <= newest.frame.stamp {
                return;
            }
            newest.error = read(&message, &mut newest.frame.forces).err();
            newest.frame.stamp = stamp;
            newest.frame.sequence += 1;
            newest.arrived = Some(Instant::now());
        };
        Ok(Self {
            newest,
            _subscription: node.subscribe::<M>(topic, Qos::SENSOR_DATA, take)?,
            freshness: Freshness {
                topic: topic.into(),
                clock,
                most,
            },
            elements,
        })
    }
}

impl TactileSensor for RosSensor {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        let (expected, actual) = (self.elements, reading.forces.len());
        if actual != expected {
            return Err(SensorError::ElementCount { expected, actual });
        }
        let newest = lock(&self.newest);
        let (stamp, arrived) = (newest.frame.stamp, newest.arrived);
        let fresh = self.freshness.check(stamp, arrived, newest.error.as_ref());
        fresh.map_err(SensorError::Failed)?;
        (reading.sequence, reading.stamp) = (newest.frame.sequence, newest.frame.stamp);
        reading.forces.copy_from_slice(&newest.frame.forces);
        Ok(())
    }
}
