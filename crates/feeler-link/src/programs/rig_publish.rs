//! Publishing of the rig program: states, images or forces, and heartbeats.

use super::error::ProgramError;
use super::rig::RigProgram;
use super::rig_config::{Rig, SensorOutput};
use super::rig_reading::{Exposed, Reading};
use crate::hand::run_clock::RigSpeed;
use crate::messages::freshness::Echo;
use crate::messages::joints::JointCounts;
use crate::messages::message::{
    DirectForces, InstrumentsMessage, MessageHeader, PictureMessage, StateMessage,
};
use crate::transport::endpoints::LinkError;
use crate::transport::outlet::header;
use feeler::hand::{HandError, HandState};
use feeler::sensor::image::Frame;
use feeler_record::wire::Vector3;

/// Interval between heartbeat updates (s).
const REPORT_INTERVAL: f64 = 0.25;

impl<R: Rig> RigProgram<R> {
    /// Reads encoders, instruments and sensors, and publishes the readings.
    pub(super) fn publish(&mut self) -> Result<(), ProgramError> {
        self.sequence += 1;
        self.published.clear();
        let instruments = self.rig.read(&mut self.state)?;
        self.update_time();
        let taken = self.taken();
        let header = header(self.node.instance, self.sequence, self.state.stamp);
        let header = header.echoing(taken.0, taken.1);
        let state = state_message(
            header,
            &self.state,
            &self.config.expected.joints,
            instruments,
        )?;
        self.send(Reading::State(state))?;
        for finger in 0..self.rig.finger_count() {
            self.expose(finger, taken)?;
        }
        self.report_by_heartbeat();
        Ok(())
    }

    /// Publishes the latest readings again, for programs that missed them. They are still valid, because the rig does
    /// not move in the meantime.
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

    /// Returns the hand's latest step and the current time (s), for the echo of readings taken now.
    fn taken(&self) -> (Echo, f64) {
        (self.node.inbox.lock().echo, self.node.now())
    }

    /// Publishes the output of the sensor of `finger`. The message echoes the hand's step in `taken`, or for a repeated
    /// image the same step as before.
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

    /// Sends `reading`, and keeps it for resending in lockstep, because another reading would have different noise.
    fn send(&mut self, reading: Reading) -> Result<(), LinkError> {
        let (topic, bytes) = reading.encoded()?;
        self.node.network.send(topic, bytes)?;
        if self.config.speed == RigSpeed::Lockstep {
            self.published.push(reading);
        }
        Ok(())
    }

    /// Updates the heartbeat, and warns about refused programs.
    pub(super) fn report_by_heartbeat(&mut self) {
        let now = self.node.now();
        let (sequence, since) = self.reported;
        if now - since < REPORT_INTERVAL {
            return;
        }
        self.reported = (self.sequence, now);
        if let Some(mismatch) = self.node.warn_of_refusals() {
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
    counts: &JointCounts,
    instruments: Option<InstrumentsMessage>,
) -> Result<StateMessage, HandError> {
    let positions = state.joints.iter().map(|joints| joints.position);
    let velocities = state.joints.iter().map(|joints| joints.velocity);
    let (effort, effort_uncertainty) = counts.efforts_to_message(&state.efforts)?;
    Ok(StateMessage {
        header,
        position: counts.to_message(positions)?,
        velocity: counts.to_message(velocities)?,
        effort,
        effort_uncertainty,
        instruments: instruments.into_iter().collect(),
    })
}
