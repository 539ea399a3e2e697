//! Sensor program of one finger: publishes the forces and flags of each image.

use super::error::{ProgramError, Warn};
use super::node::{Node, first_heartbeat};
use crate::inboxes::peers::Expected;
use crate::inboxes::sense_inbox::{Exposed, SenseInbox};
use crate::messages::message::{MessageHeader, ProgramKind, TactileUpdate};
use crate::transport::network::Network;
use crate::transport::outlet::header;
use crate::transport::topic::Topic;
use feeler::control::{FlagAnalyzer, FlagThresholds, TactileReading};
use feeler::sensor::forces::NO_FORCE;
use glam::DVec3;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Number of tactile updates between heartbeat updates.
const REPORT_UPDATES: u64 = 25;

/// Configuration of a sensor program.
#[derive(Debug, Clone)]
pub struct SensorConfig {
    /// Finger index, from 0.
    pub finger: usize,
    /// Number of sensing elements.
    pub elements: usize,
    /// Image size: width and height (px).
    pub picture_size: (usize, usize),
    /// Thresholds of the flags.
    pub thresholds: FlagThresholds,
    /// SHA-256 of the fingertip.
    pub fingertip: String,
    /// Configuration that other programs must match.
    pub expected: Expected,
}

/// Program that publishes the tactile updates of one finger.
pub struct SensorProgram {
    finger: usize,
    touch: TactileReading,
    analyzer: FlagAnalyzer,
    slip_threshold: f64,
    node: Node<SenseInbox>,
    updates: u64,
    /// Number of updates and time (s) at the last heartbeat update.
    reported: (u64, f64),
}

impl SensorProgram {
    /// Creates a sensor program on `network`.
    ///
    /// # Errors
    /// If the network fails.
    pub fn new(config: &SensorConfig, network: Arc<dyn Network>) -> Result<Self, ProgramError> {
        let (finger, elements) = (config.finger, config.elements);
        let expected = config.expected.clone();
        let mut heartbeat = first_heartbeat(ProgramKind::Sense, &expected.experiment);
        heartbeat.finger = finger as u32;
        heartbeat.fingertip.clone_from(&config.fingertip);
        let inbox = SenseInbox::new(finger, elements, config.picture_size, expected);
        let topics = [
            Topic::Mode,
            Topic::Picture(finger),
            Topic::DirectForces(finger),
        ];
        Ok(Self {
            finger,
            touch: TactileReading::none(elements),
            analyzer: FlagAnalyzer::new(config.thresholds, elements),
            slip_threshold: config.thresholds.slip_threshold,
            node: Node::start(network, heartbeat, inbox, &topics)?,
            updates: 0,
            reported: (0, 0.0),
        })
    }

    /// Sets the callback for warnings about refused programs and sensor faults.
    pub fn set_warn(&mut self, warn: Warn) {
        self.node.set_warn(warn);
    }

    /// Returns the oldest queued image or forces of a remote rig. Waits for at most `longest`.
    pub fn next_exposed(&self, longest: Duration) -> Option<Exposed> {
        let mut next = None;
        self.node.inbox.wait_for(longest, |inbox| {
            next = inbox.take_next();
            next.is_some()
        });
        next
    }

    /// Publishes the forces of a local camera's image with frame sequence number `sequence` (from 0), taken at `stamp`
    /// (s, on the camera's clock) and received at `at`. `forces` contains the force on each element in its frame `E_i`
    /// (N), or `None` if invalid.
    ///
    /// # Errors
    /// If the network fails.
    pub fn publish(
        &mut self,
        (sequence, stamp, at): (u64, f64, Instant),
        forces: impl Iterator<Item = Option<DVec3>>,
    ) -> Result<(), ProgramError> {
        let came = self.node.now() - at.elapsed().as_secs_f64();
        let echo = self.node.inbox.lock().echo_at(came);
        // Message sequence numbers start at 1.
        let header = header(self.node.instance, sequence + 1, stamp);
        let header = header.echoing(echo, came);
        self.publish_update(header, sequence, at, forces)
    }

    /// Publishes the forces of an image from a remote rig, received at `at`. `taken` and `number` are the header and
    /// the frame sequence number of the image; `forces` is as in [`publish`](Self::publish).
    ///
    /// # Errors
    /// If the network fails.
    pub fn publish_exposed(
        &mut self,
        (taken, number): (MessageHeader, u64),
        at: Instant,
        forces: impl Iterator<Item = Option<DVec3>>,
    ) -> Result<(), ProgramError> {
        let header = MessageHeader {
            instance: self.node.instance,
            ..taken
        };
        self.publish_update(header, number, at, forces)
    }

    fn publish_update(
        &mut self,
        header: MessageHeader,
        number: u64,
        at: Instant,
        forces: impl Iterator<Item = Option<DVec3>>,
    ) -> Result<(), ProgramError> {
        let frame = &mut self.touch.frame;
        for (force, sensed) in frame.forces.iter_mut().zip(forces) {
            *force = sensed.unwrap_or(NO_FORCE);
        }
        (frame.sequence, frame.stamp) = (number, header.stamp);
        self.touch.analyze(&mut self.analyzer);
        let update = TactileUpdate::of_touch(header, self.finger, &self.touch, self.slip_threshold);
        self.node.publish(Topic::Tactile(self.finger), &update)?;
        self.updates += 1;
        if self.updates.is_multiple_of(REPORT_UPDATES) {
            self.report_by_heartbeat(at);
        }
        Ok(())
    }

    /// Reports a sensor fault to the operator, and to the other programs through the heartbeat.
    pub fn warn(&mut self, what: &str) {
        self.node.warn(what);
        let fault = what.to_string();
        self.node.beacon.update(|heartbeat| heartbeat.fault = fault);
    }

    /// Warns about refused programs.
    pub fn check_peers(&mut self) {
        self.node.warn_of_refusals();
    }

    fn report_by_heartbeat(&mut self, newest: Instant) {
        let (updates, now) = (self.updates, self.node.now());
        let rate = (updates - self.reported.0) as f64 / (now - self.reported.1).max(1e-9);
        self.reported = (updates, now);
        let inbox = self.node.inbox.lock();
        self.node.beacon.update(|heartbeat| {
            heartbeat.rate = rate;
            heartbeat.age = newest.elapsed().as_secs_f64();
            heartbeat.lost = inbox.lost;
            heartbeat.refused = inbox.rejected.total();
        });
    }
}
