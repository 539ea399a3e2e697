//! What the world says: state, pictures or forces, and how it goes.

use super::World;
use crate::CommandError;
use feeler::hand::hand::{HandState, JointState};
use feeler_lab::experiment::Instruments;
use feeler_lab::experiment::played_rig::Exposure;
use feeler_link::inbox::Inbox;
use feeler_link::message::{
    DirectForces, HandState as StateMessage, Header, Instruments as InstrumentsMessage, Picture,
};
use feeler_link::outlet::header;
use feeler_link::topic::Topic;
use feeler_record::wire::{Message, Vector3, cdr};
use glam::DVec3;
use std::io::{Write, stderr};

/// Time between two reports of how it goes, s.
const REPORT_INTERVAL: f64 = 0.25;

impl World {
    /// Says what encoders, instruments and sensors say now.
    pub(super) fn publish(&mut self) -> Result<(), CommandError> {
        self.sequence += 1;
        self.said.clear();
        let instruments = self.rig.read(&mut self.state)?;
        let echo = self.echo();
        let head = self.header(self.state.stamp, echo);
        let state = state_message(head, &self.state, &instruments);
        self.say(Topic::State, &state)?;
        for finger in 0..self.rig.fingers() {
            self.expose(finger, echo)?;
        }
        self.report();
        Ok(())
    }

    /// Says what the sensor of `finger` delivers. A picture that comes again echoes what it did.
    fn expose(&mut self, finger: usize, echo: (u64, f64)) -> Result<(), CommandError> {
        let (number, stamp) = match self.rig.expose(finger)? {
            Exposure::Picture(frame) => (frame.sequence, frame.stamp),
            Exposure::Forces(frame) => (frame.sequence, frame.stamp),
        };
        let (newest, of_newest) = &mut self.exposed[finger];
        if newest.replace(number) != Some(number) {
            *of_newest = echo;
        }
        let head = self.header(stamp, self.exposed[finger].1);
        let index = finger as u32;
        match self.rig.exposed(finger) {
            Exposure::Picture(frame) => {
                let picture = Picture {
                    header: head,
                    finger: index,
                    frame: number,
                    width: frame.picture.width as u32,
                    height: frame.picture.height as u32,
                    pixels: frame.picture.pixels.clone(),
                };
                self.say(Topic::Picture(finger), &picture)
            }
            Exposure::Forces(frame) => {
                let forces = DirectForces {
                    header: head,
                    finger: index,
                    frame: number,
                    forces: frame.forces.iter().map(|&f| Vector3::from(f)).collect(),
                };
                self.say(Topic::DirectForces(finger), &forces)
            }
        }
    }

    /// The hand's newest step, and how long ago it was heard, s.
    fn echo(&self) -> (u64, f64) {
        let echo = self.inbox.lock().echo;
        (echo.step, (self.clock)() - echo.arrived)
    }

    fn header(&self, stamp: f64, (echo_step, echo_age): (u64, f64)) -> Header {
        Header {
            echo_step,
            echo_age,
            ..header(self.instance, self.sequence, stamp)
        }
    }

    fn say<M: Message>(&mut self, topic: Topic, message: &M) -> Result<(), CommandError> {
        let mut bytes = Vec::new();
        cdr::encode(message, &mut bytes)?;
        if self.in_step {
            self.said.push((topic, bytes.clone()));
        }
        Ok(self.network.send(topic, bytes)?)
    }

    /// Says the newest again: somebody may not have been there.
    pub(super) fn say_again(&mut self) -> Result<(), CommandError> {
        for (topic, bytes) in &self.said {
            self.network.send(*topic, bytes.clone())?;
        }
        self.report();
        Ok(())
    }

    /// Tells the other programs how it goes, and the user of programs that are refused.
    fn report(&mut self) {
        let now = (self.clock)();
        let (sequence, since) = self.reported;
        if now - since < REPORT_INTERVAL {
            return;
        }
        self.reported = (self.sequence, now);
        let inbox = self.inbox.lock();
        for mismatch in self.refusals.new_ones(inbox.peers()) {
            // Where nobody listens, the heartbeat says it.
            let _ = writeln!(stderr(), "refused: {mismatch}");
            self.fault = mismatch.to_string();
        }
        let rate = (self.sequence - sequence) as f64 / (now - since);
        self.beacon.update(|heartbeat| {
            heartbeat.rate = rate;
            heartbeat.refused = inbox.rejected.total() + inbox.stale_commands;
            heartbeat.missed = self.missed;
            heartbeat.fault.clone_from(&self.fault);
        });
    }
}

fn state_message(header: Header, state: &HandState, at: &Instruments) -> StateMessage {
    let joints = |pick: fn(&JointState) -> DVec3| {
        let joints = state.joints.iter();
        joints.map(|joint| Vector3::from(pick(joint))).collect()
    };
    StateMessage {
        header,
        position: joints(|joint| joint.position),
        velocity: joints(|joint| joint.velocity),
        instruments: vec![InstrumentsMessage {
            torque: at.torque.torque,
            bridge_voltage: at.torque.voltage,
            counts: at.torque.counts,
            cap_angle: at.cap.angle,
            cap_centre: at.cap_centre.into(),
            cap_torque: at.cap.torque,
            slipped: at.slipped,
        }],
    }
}
