//! What the rig program publishes: state, pictures or forces, and heartbeats.

use super::error::ProgramError;
use super::rig::{Exposed, RigProgram};
use super::rig_config::{Rig, SensorOutput};
use crate::endpoints::LinkError;
use crate::freshness::Echo;
use crate::message::{
    DirectForces, InstrumentsMessage, MessageHeader, PictureMessage, StateMessage,
};
use crate::outlet::{encode, header};
use crate::run_clock::RigSpeed;
use crate::topic::Topic;
use feeler::hand::{HandState, JointState};
use feeler::sensor::frame::Frame;
use feeler_record::wire::Vector3;
use glam::DVec3;

/// Time between two reports by heartbeat, s.
const REPORT_INTERVAL: f64 = 0.25;

/// A message of what was read, which may be published again.
pub(super) enum Reading {
    State(StateMessage),
    Picture(usize, PictureMessage),
    Forces(usize, DirectForces),
}

impl Reading {
    fn header_mut(&mut self) -> &mut MessageHeader {
        match self {
            Self::State(message) => &mut message.header,
            Self::Picture(_, message) => &mut message.header,
            Self::Forces(_, message) => &mut message.header,
        }
    }

    /// Its topic and bytes.
    fn encoded(&self) -> Result<(Topic, Vec<u8>), LinkError> {
        Ok(match self {
            Self::State(message) => (Topic::State, encode(message)?),
            Self::Picture(finger, message) => (Topic::Picture(*finger), encode(message)?),
            Self::Forces(finger, message) => (Topic::DirectForces(*finger), encode(message)?),
        })
    }
}

impl<R: Rig> RigProgram<R> {
    /// Publishes what encoders, instruments and sensors read now.
    pub(super) fn publish(&mut self) -> Result<(), ProgramError> {
        self.sequence += 1;
        self.published.clear();
        let instruments = self.rig.read(&mut self.state)?;
        self.update_time();
        let taken = self.taken();
        let header = header(self.node.instance, self.sequence, self.state.stamp);
        let header = header.echoing(taken.0, taken.1);
        let state = state_message(header, &self.state, instruments);
        self.send(Reading::State(state))?;
        for finger in 0..self.rig.finger_count() {
            self.expose(finger, taken)?;
        }
        self.report_by_heartbeat();
        Ok(())
    }

    /// Publishes the newest again, as somebody may not have been there. The rig stands still meanwhile, so that it is
    /// true now.
    pub(super) fn publish_again(&mut self) -> Result<(), ProgramError> {
        let (echo, time) = self.taken();
        for reading in &mut self.published {
            let header = reading.header_mut();
            *header = header.echoing(echo, time);
            let (topic, bytes) = reading.encoded()?;
            self.node.network.send(topic, bytes)?;
        }
        self.report_by_heartbeat();
        Ok(())
    }

    /// The hand's newest step, and the time, s: what is read now echoes.
    fn taken(&self) -> (Echo, f64) {
        (self.node.inbox.lock().echo, self.node.now())
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
        let reading = match exposure {
            SensorOutput::Picture(frame) => {
                Reading::Picture(finger, picture_message(header, finger, frame))
            }
            SensorOutput::Forces(frame) => {
                let forces = frame.forces.iter().map(|&f| Vector3::from(f));
                let message = DirectForces {
                    header,
                    finger: finger as u32,
                    frame: number,
                    forces: forces.collect(),
                };
                Reading::Forces(finger, message)
            }
        };
        Ok(self.send(reading)?)
    }

    /// Sends `reading`, and keeps it where the hand's answer is waited for. To read again would draw other noise.
    fn send(&mut self, reading: Reading) -> Result<(), LinkError> {
        let (topic, bytes) = reading.encoded()?;
        self.node.network.send(topic, bytes)?;
        if self.config.speed == RigSpeed::Lockstep {
            self.published.push(reading);
        }
        Ok(())
    }

    /// Reports by heartbeat, and warns of programs that are refused.
    pub(super) fn report_by_heartbeat(&mut self) {
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
