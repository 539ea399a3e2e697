//! The sensor program of one finger: publishes the forces and flags of each picture.

use super::error::{ProgramError, Warn};
use super::node::{Node, first_heartbeat};
use crate::message::{MessageHeader, ProgramKind, TactileUpdate};
use crate::network::Network;
use crate::outlet::header;
use crate::peers::Expected;
use crate::sense_inbox::{Exposed, SenseInbox};
use crate::topic::Topic;
use feeler::control::flags::{FlagAnalyzer, FlagThresholds};
use feeler::control::touch::FingerTouch;
use feeler::sensor::reading::NO_FORCE;
use glam::DVec3;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Updates between two reports by heartbeat.
const REPORT_UPDATES: u64 = 25;

/// What a sensor program is made of.
#[derive(Debug, Clone)]
pub struct SensorConfig {
    /// The finger, from 0.
    pub finger: usize,
    /// Number of its sensing elements.
    pub elements: usize,
    /// Size of its pictures, columns and rows, px.
    pub picture_size: (usize, usize),
    /// Thresholds of its flags.
    pub thresholds: FlagThresholds,
    /// SHA-256 of the fingertip that it senses by.
    pub fingertip: String,
    /// What the other programs must agree in.
    pub expected: Expected,
}

/// Publishes what one finger feels.
pub struct SensorProgram {
    finger: usize,
    touch: FingerTouch,
    analyzer: FlagAnalyzer,
    slip_threshold: f64,
    node: Node<SenseInbox>,
    updates: u64,
    /// Number and time (s) of the last report.
    reported: (u64, f64),
}

impl SensorProgram {
    /// The sensor of `config` on `network`.
    ///
    /// # Errors
    /// When the network does not listen.
    pub fn new(config: &SensorConfig, network: Arc<dyn Network>) -> Result<Self, ProgramError> {
        let (finger, elements) = (config.finger, config.elements);
        let expected = config.expected.clone();
        let mut heartbeat = first_heartbeat(ProgramKind::Sense, &expected.experiment);
        heartbeat.finger = finger as u32;
        heartbeat.fingertip.clone_from(&config.fingertip);
        let inbox = SenseInbox::new((finger, elements), config.picture_size, expected);
        let topics = [
            Topic::Mode,
            Topic::Picture(finger),
            Topic::DirectForces(finger),
        ];
        Ok(Self {
            finger,
            touch: FingerTouch::none(elements),
            analyzer: FlagAnalyzer::new(config.thresholds, elements),
            slip_threshold: config.thresholds.slip_threshold,
            node: Node::start(network, heartbeat, inbox, &topics)?,
            updates: 0,
            reported: (0, 0.0),
        })
    }

    /// Warnings go to `warn`: which programs it refuses.
    pub fn set_warn(&mut self, warn: Warn) {
        self.node.set_warn(warn);
    }

    /// The oldest picture of a rig in another program that waits to be sensed; waits for one for at most `longest`.
    pub fn next_exposed(&self, longest: Duration) -> Option<Exposed> {
        let mut next = None;
        self.node.inbox.wait_for(longest, |inbox| {
            next = inbox.take_next();
            next.is_some()
        });
        next
    }

    /// Publishes the forces of a camera's picture: number `sequence` from 0, taken at `stamp` (s on the camera's own
    /// clock), which came in at `at`. `forces`: one for each element in its frame `E_i`, N; none where there is no
    /// valid one.
    ///
    /// # Errors
    /// When the network fails.
    pub fn publish(
        &mut self,
        (sequence, stamp, at): (u64, f64, Instant),
        forces: impl Iterator<Item = Option<DVec3>>,
    ) -> Result<(), ProgramError> {
        let came = self.node.now() - at.elapsed().as_secs_f64();
        let echo = self.node.inbox.lock().echo_at(came);
        // From 1, as everywhere.
        let header = header(self.node.instance, sequence + 1, stamp);
        let header = header.echoing(echo, came);
        self.publish_update(header, sequence, at, forces)
    }

    /// Publishes the forces of what a rig in another program exposed, which came in at `at`: the header and number of
    /// that are `taken`.
    ///
    /// # Errors
    /// When the network fails.
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

    /// Warns whoever runs the program, and the others by heartbeat, of something that is wrong with the sensor.
    pub fn warn(&mut self, what: &str) {
        self.node.warn(what);
        let fault = what.to_string();
        self.node.beacon.update(|heartbeat| heartbeat.fault = fault);
    }

    /// Warns of programs that are refused.
    pub fn check_peers(&mut self) {
        for mismatch in self.node.new_refusals() {
            self.node.warn(&format!("refused: {mismatch}"));
        }
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
