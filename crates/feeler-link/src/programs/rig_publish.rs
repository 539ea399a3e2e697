//! What the rig program publishes: state, pictures or forces, and heartbeats.

use super::error::ProgramError;
use super::rig::{Exposed, RigProgram};
use super::rig_config::{Rig, SensorOutput};
use crate::freshness::Echo;
use crate::message::{
    DirectForces, InstrumentsMessage, MessageHeader, PictureMessage, StateMessage,
};
use crate::outlet::{encode, header};
use crate::topic::Topic;
use feeler::hand::{HandState, JointState};
use feeler::sensor::frame::Frame;
use feeler_record::wire::Vector3;
use glam::DVec3;

/// Time between two reports by heartbeat, s.
const REPORT_INTERVAL: f64 = 0.25;

impl<R: Rig> RigProgram<R> {
    /// Publishes what encoders, instruments and sensors read now.
    pub(super) fn publish(&mut self) -> Result<(), ProgramError> {
        self.sequence += 1;
        self.instruments = self.rig.read(&mut self.state)?;
        self.update_time();
        self.publish_read()
    }

    /// Publishes the newest again, as somebody may not have been there. The rig stands still meanwhile, so that it is
    /// true now.
    pub(super) fn publish_again(&mut self) -> Result<(), ProgramError> {
        self.exposed.fill(None);
        self.publish_read()
    }

    fn publish_read(&mut self) -> Result<(), ProgramError> {
        let taken = (self.node.inbox.lock().echo, self.node.now());
        let header = header(self.node.instance, self.sequence, self.state.stamp);
        let state = state_message(
            header.echoing(taken.0, taken.1),
            &self.state,
            self.instruments,
        );
        self.node.publish(Topic::State, &state)?;
        for finger in 0..self.rig.finger_count() {
            self.expose(finger, taken)?;
        }
        self.report_by_heartbeat();
        Ok(())
    }

    /// Publishes what the sensor of `finger` delivers. A picture that comes again echoes what it did when it was
    /// `taken`.
    fn expose(&mut self, finger: usize, taken: (Echo, f64)) -> Result<(), ProgramError> {
        let failed = |source| ProgramError::Sensor { finger, source };
        let Some(exposure) = self.rig.expose(finger).map_err(failed)? else {
            return Ok(());
        };
        let (number, stamp) = match exposure {
            SensorOutput::Picture(frame) => (frame.sequence, frame.stamp),
            SensorOutput::Forces(frame) => (frame.sequence, frame.stamp),
        };
        let same = self.exposed[finger].filter(|newest| newest.number == number);
        let newest = same.unwrap_or(Exposed { number, taken });
        self.exposed[finger] = Some(newest);
        let header = header(self.node.instance, self.sequence, stamp)
            .echoing(newest.taken.0, newest.taken.1);
        let (topic, bytes) = match exposure {
            SensorOutput::Picture(frame) => {
                let message = picture_message(header, finger, frame);
                (Topic::Picture(finger), encode(&message)?)
            }
            SensorOutput::Forces(frame) => {
                let forces = frame.forces.iter().map(|&f| Vector3::from(f));
                let message = DirectForces {
                    header,
                    finger: finger as u32,
                    frame: number,
                    forces: forces.collect(),
                };
                (Topic::DirectForces(finger), encode(&message)?)
            }
        };
        Ok(self.node.network.send(topic, bytes)?)
    }

    /// Reports by heartbeat, and warns of programs that are refused.
    fn report_by_heartbeat(&mut self) {
        let now = self.node.now();
        let (sequence, since) = self.reported;
        if now - since < REPORT_INTERVAL {
            return;
        }
        self.reported = (self.sequence, now);
        for mismatch in self.node.new_refusals() {
            self.node.warn(&format!("refused: {mismatch}"));
            self.warning = mismatch.to_string();
        }
        let inbox = self.node.inbox.lock();
        let rate = (self.sequence - sequence) as f64 / (now - since);
        self.node.beacon.update(|heartbeat| {
            heartbeat.rate = rate;
            heartbeat.refused = inbox.rejected.total() + inbox.stale_commands;
            heartbeat.missed = self.missed;
            heartbeat.fault.clone_from(&self.warning);
        });
    }
}

fn picture_message(header: MessageHeader, finger: usize, frame: &Frame) -> PictureMessage {
    PictureMessage {
        header,
        finger: finger as u32,
        frame: frame.sequence,
        width: frame.picture.width as u32,
        height: frame.picture.height as u32,
        pixels: frame.picture.pixels.clone(),
    }
}

fn state_message(
    header: MessageHeader,
    state: &HandState,
    instruments: Option<InstrumentsMessage>,
) -> StateMessage {
    let joints = |pick: fn(&JointState) -> DVec3| {
        let joints = state.joints.iter();
        joints.map(|joint| Vector3::from(pick(joint))).collect()
    };
    StateMessage {
        header,
        position: joints(|joint| joint.position),
        velocity: joints(|joint| joint.velocity),
        instruments: instruments.into_iter().collect(),
    }
}
