//! Received data of a rig, restricted to programs that are still alive.

use super::programs::warnings;
use crate::snapshot::{Fault, UNKNOWN};
use feeler::control::FingerFlags;
use feeler::hand::JointVector;
use feeler_link::inboxes::{Inbox, WatchInbox};
use feeler_link::messages::message::{
    HandMode, InstrumentsMessage, NO_FINGER, ProgramKind, StateMessage, TactileUpdate,
};
use glam::DVec3;

/// Latest data from programs that are still alive. Data from other programs is omitted as outdated.
pub struct RigMessages<'a> {
    /// Messages received from the rig.
    pub inbox: &'a WatchInbox,
    now: f64,
    /// Mode of the hand.
    pub mode: Option<&'a HandMode>,
    /// State of the joints.
    pub state: Option<&'a StateMessage>,
}

impl<'a> RigMessages<'a> {
    /// Selects the valid contents of `inbox` at `now` (s).
    pub fn new(inbox: &'a WatchInbox, now: f64) -> Self {
        let mode = inbox.mode();
        let state = inbox.state();
        let is_there = |program, instance| is_there(inbox, program, NO_FINGER, instance, now);
        Self {
            inbox,
            now,
            mode: mode.filter(|mode| is_there(ProgramKind::Hand, mode.header.instance)),
            state: state.filter(|state| is_there(ProgramKind::World, state.header.instance)),
        }
    }

    /// Returns the flags and the tactile update of `finger`.
    pub fn finger(&self, finger: usize) -> Option<(FingerFlags, &TactileUpdate)> {
        let felt = self.inbox.finger(finger);
        felt.filter(|(_, update)| {
            let instance = update.header.instance;
            is_there(
                self.inbox,
                ProgramKind::Sense,
                update.finger,
                instance,
                self.now,
            )
        })
    }

    /// Returns the joint positions (rad or m) of each finger. Empty before the first state.
    pub fn positions(&self) -> impl Iterator<Item = JointVector> + Clone {
        let positions = self.state.map_or(&[][..], |state| &state.position);
        self.inbox.peers().joints().of_message(positions)
    }

    /// Returns the joint velocities (rad/s or m/s) of each finger. Empty before the first state.
    pub fn velocities(&self) -> impl Iterator<Item = JointVector> + Clone {
        let velocities = self.state.map_or(&[][..], |state| &state.velocity);
        self.inbox.peers().joints().of_message(velocities)
    }

    /// Returns the readings of the rig's instruments.
    pub fn instruments(&self) -> Option<InstrumentsMessage> {
        self.state?.instruments.first().copied()
    }

    /// Returns the current faults.
    pub fn faults(&self) -> Vec<String> {
        let stopped = self.mode.filter(|mode| !mode.stopped.is_empty());
        let stopped = stopped.map(|mode| {
            let stops = mode.stops.iter().map(|stop| {
                let number = stop.number;
                match mode.stopped.contains(&stop.by) {
                    true => format!(" (stop {number})"),
                    false => format!(" (stop {number}: {})", stop.by),
                }
            });
            let stops: String = stops.collect();
            format!("the hand is stopped: {}{stops}", mode.stopped)
        });
        let warnings = warnings(self.inbox.peers(), self.now);
        stopped.into_iter().chain(warnings).collect()
    }

    /// Returns the latest fault that a program reports in its heartbeat, if any. It is marked as over, and its time is
    /// unknown.
    pub fn said(&self) -> Option<Fault> {
        let peers = self.inbox.peers().all().iter();
        let mut said = peers.filter(|peer| peer.refused.is_none() && !peer.is_silent(self.now));
        let peer = said.find(|peer| !peer.heartbeat.fault.is_empty())?;
        Some(Fault {
            time: UNKNOWN,
            words: format!("{} reports: {}", peer.name(), peer.heartbeat.fault),
            over: true,
        })
    }
}

fn is_there(
    inbox: &WatchInbox,
    program: ProgramKind,
    finger: u32,
    instance: u64,
    now: f64,
) -> bool {
    inbox
        .peers()
        .taken(program, now)
        .any(|peer| (peer.heartbeat.instance, peer.heartbeat.finger) == (instance, finger))
}

/// Returns flags, forces and shear rates for a finger without data.
pub fn nothing_felt(elements: usize) -> (FingerFlags, Vec<DVec3>, Vec<f64>) {
    let flags = FingerFlags {
        grasp_force: UNKNOWN,
        ..FingerFlags::default()
    };
    (flags, vec![DVec3::NAN; elements], vec![UNKNOWN; elements])
}
