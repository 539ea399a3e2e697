//! Uses a ROS 2 sensor as a fingertip: reads forces from `geometry_msgs/WrenchStamped` or `sensor_msgs/PointCloud2`.

use crate::cloud::{CloudError, read_forces};
use crate::freshness::{Freshness, GraphClock, lock, seconds};
use crate::node::{Node, Subscription};
use crate::node_error::NodeError;
use crate::qos::Qos;
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler_record::ros::{PointCloud2, Time, WrenchStamped};
use feeler_record::wire::{Message, cdr};
use glam::DVec3;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Age limit for a sensor's data.
#[derive(Clone)]
pub struct SensorAge {
    /// Clock of the stamps.
    pub clock: GraphClock,
    /// Maximum age (s, by `clock`).
    pub most: f64,
    /// Speed of `clock` relative to real time; 1 unless simulated.
    pub speed: f64,
}

/// [`TactileSensor`] that receives its forces from a ROS 2 topic. Reading returns the latest forces and their stamp,
/// without waiting.
pub struct RosSensor {
    heard: Arc<Heard>,
    freshness: Arc<Freshness>,
    elements: usize,
    _subscription: Subscription,
}

#[derive(Debug)]
struct Heard {
    newest: Mutex<Newest>,
    changed: Condvar,
}

/// Latest forces, updated by the subscription.
#[derive(Debug)]
struct Newest {
    frame: TactileFrame,
    /// Time of arrival, or `None` before the first message.
    arrived: Option<Instant>,
    /// Error in the latest message, if any.
    error: Option<CloudError>,
}

impl RosSensor {
    /// Creates a fingertip with one element from the wrenches on `topic`. Their force acts on the fingertip, exerted by
    /// the touched object (N), in a frame whose z axis points outward. Torques are ignored.
    ///
    /// # Errors
    /// If `topic` is not a valid name, or the node's session is closed.
    pub fn wrench(node: &mut Node, topic: &str, age: SensorAge) -> Result<Self, NodeError> {
        let read = |message: &WrenchStamped, forces: &mut [DVec3]| {
            let force = DVec3::from(message.wrench.force);
            // Compression is the force along the inward normal.
            forces.fill(force.with_z(-force.z));
            Ok(())
        };
        let stamp = |message: &WrenchStamped| message.header.stamp;
        Self::listen(node, topic, 1, age, stamp, read)
    }

    /// Creates a fingertip with this number of `elements` from the clouds on `topic`, read with [`read_forces`].
    ///
    /// # Errors
    /// Same as [`wrench`](Self::wrench).
    pub fn cloud(
        node: &mut Node,
        topic: &str,
        elements: usize,
        age: SensorAge,
    ) -> Result<Self, NodeError> {
        let stamp = |message: &PointCloud2| message.header.stamp;
        Self::listen(node, topic, elements, age, stamp, read_forces)
    }

    fn listen<M: Message + 'static>(
        node: &mut Node,
        topic: &str,
        elements: usize,
        SensorAge { clock, most, speed }: SensorAge,
        stamp: fn(&M) -> Time,
        read: fn(&M, &mut [DVec3]) -> Result<(), CloudError>,
    ) -> Result<Self, NodeError> {
        let heard = Arc::new(Heard {
            newest: Mutex::new(Newest {
                frame: TactileFrame::unloaded(elements),
                arrived: None,
                error: None,
            }),
            changed: Condvar::new(),
        });
        let freshness = Arc::new(Freshness {
            topic: topic.into(),
            clock,
            most,
            speed,
        });
        let (theirs, judge) = (Arc::clone(&heard), Arc::clone(&freshness));
        let take = move |bytes: &[u8], _| {
            let Ok(message) = cdr::decode::<M>(bytes) else {
                return;
            };
            let (mut newest, stamp) = (lock(&theirs.newest), seconds(stamp(&message)));
            if !judge.is_news(stamp, newest.frame.stamp, newest.arrived) {
                return;
            }
            newest.error = read(&message, &mut newest.frame.forces).err();
            newest.frame.stamp = stamp;
            newest.frame.sequence += 1;
            newest.arrived = Some(Instant::now());
            theirs.changed.notify_all();
        };
        Ok(Self {
            heard,
            _subscription: node.subscribe::<M>(topic, Qos::SENSOR_DATA, take)?,
            freshness,
            elements,
        })
    }

    /// Waits for at most `longest` until the sequence number of the latest data differs from `sequence` (0 before the
    /// first data). Returns `false` on timeout.
    pub fn wait_for_next(&self, sequence: u64, longest: Duration) -> bool {
        let is_old = |newest: &mut Newest| newest.frame.sequence == sequence;
        let waited =
            self.heard
                .changed
                .wait_timeout_while(lock(&self.heard.newest), longest, is_old);
        let (newest, _) = waited.unwrap_or_else(PoisonError::into_inner);
        newest.frame.sequence != sequence
    }

    /// Like [`read`](TactileSensor::read), but also returns the time of measurement on this computer's clock. Sets the
    /// sequence number and stamp of `reading` even if the data are too old or invalid.
    ///
    /// # Errors
    /// Same as [`read`](TactileSensor::read).
    pub fn read_measured(&self, reading: &mut TactileFrame) -> Result<Instant, SensorError> {
        reading.check_elements(self.elements)?;
        let newest = lock(&self.heard.newest);
        (reading.sequence, reading.stamp) = (newest.frame.sequence, newest.frame.stamp);
        let (stamp, arrived) = (newest.frame.stamp, newest.arrived);
        let fresh = self.freshness.check(stamp, arrived, newest.error.as_ref());
        let age = fresh.map_err(SensorError::Failed)? / self.freshness.speed;
        reading.forces.copy_from_slice(&newest.frame.forces);
        let now = Instant::now();
        let age = Duration::try_from_secs_f64(age).unwrap_or(Duration::MAX);
        // An `Instant` cannot precede the start of the computer.
        Ok(now.checked_sub(age).unwrap_or(now))
    }
}

impl TactileSensor for RosSensor {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        self.read_measured(reading).map(drop)
    }
}
