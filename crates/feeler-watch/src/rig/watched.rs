//! Received data of a rig as a [`Snapshot`] to render.

use super::heard::{RigMessages, nothing_felt};
use super::programs::programs;
use crate::history::History;
use crate::snapshot::{Fault, Finger, Snapshot, TaskState, TimeBase, Torque, UNKNOWN};
use feeler::control::Phase;
use feeler::hand::JointVector;
use feeler::sensor::fingertip::ElementLayout;
use feeler_console::CommandError;
use feeler_lab::config::{Experiment, ExperimentConfig};
use feeler_lab::experiment::layouts;
use feeler_lab::experiment::rigs::linked::expected;
use feeler_link::hand::{Order, stop_to_resume};
use feeler_link::inboxes::{Inbox, WatchInbox};
use feeler_link::messages::message::{HandMode, InstrumentsMessage};
use feeler_link::transport::{LinkError, Network, Shared, TimeSource, Topic, monotonic};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// Number of times an order is sent, because the network may drop a message.
const REPEATS: usize = 3;
/// Interval between repeated orders.
const INTERVAL: Duration = Duration::from_millis(10);

/// A rig that is being watched.
pub struct WatchedRig {
    rig: String,
    config: ExperimentConfig,
    /// SHA-256 of the experiment that defines thresholds and layouts.
    experiment: String,
    layouts: Vec<ElementLayout>,
    network: Arc<dyn Network>,
    inbox: Shared<WatchInbox>,
    clock: TimeSource,
    torque: History,
    /// Instance of the program whose torques the history contains.
    torque_of: Option<u64>,
    /// `true` once the hand has been found without faults.
    was_well: bool,
    fault: Option<Fault>,
}

impl WatchedRig {
    /// Subscribes to the `rig` of `experiment`. Sends nothing.
    pub fn new(
        experiment: &Experiment,
        rig: &str,
        network: Arc<dyn Network>,
    ) -> Result<Self, CommandError> {
        let layouts = layouts(&experiment.config)?;
        let elements: Vec<_> = layouts.iter().map(|layout| layout.elements.len()).collect();
        let expected = expected(experiment)?;
        let inbox = WatchInbox::new(&elements, expected.fingertips, expected.joints);
        let (topics, inbox, clock) = (inbox.topics(), Shared::new(inbox), monotonic());
        for topic in topics {
            let (inbox, clock) = (inbox.clone(), clock.clone());
            let heard = move |topic, bytes: &[u8]| {
                // The inbox counts rejected messages.
                let _ = inbox.lock().take(topic, bytes, clock());
                if topic == Topic::State {
                    inbox.changed();
                }
            };
            network.listen(topic, Arc::new(heard))?;
        }
        Ok(Self {
            rig: rig.into(),
            config: experiment.config.clone(),
            experiment: experiment.sha256(),
            layouts,
            network,
            inbox,
            clock,
            torque: History::default(),
            torque_of: None,
            was_well: false,
            fault: None,
        })
    }

    /// Returns the rig's name.
    pub fn rig(&self) -> &str {
        &self.rig
    }

    /// Stops the hand on behalf of `from`.
    pub fn stop(&self, from: &str) -> Result<(), LinkError> {
        self.send(&Order::stop(from).0)
    }

    /// Resumes the stop that `from` may resume, if any.
    pub fn resume(&self, from: &str) -> Result<(), LinkError> {
        let number = self.to_resume(from);
        number.map_or(Ok(()), |number| self.send(&Order::resume(from, number)))
    }

    fn send(&self, order: &Order) -> Result<(), LinkError> {
        for _ in 0..REPEATS {
            order.send(&*self.network)?;
            thread::sleep(INTERVAL);
        }
        Ok(())
    }

    /// Returns the number of the stop that `from` may resume, if any.
    fn to_resume(&self, from: &str) -> Option<u64> {
        let inbox = self.inbox.lock();
        let stops = &inbox.mode()?.stops;
        Some(stop_to_resume(stops, from)?.number)
    }

    /// Returns `true` if the hand reports that it is stopped.
    pub fn is_stopped(&self) -> bool {
        self.heard(|heard| heard.mode.is_some_and(|mode| !mode.stopped.is_empty()))
    }

    /// Returns the readings of the rig's instruments.
    pub fn instruments(&self) -> Option<InstrumentsMessage> {
        self.heard(|heard| heard.instruments())
    }

    /// Returns `true` if any program of the rig has been found.
    pub fn hears_somebody(&self) -> bool {
        let inbox = self.inbox.lock();
        inbox.peers().all().iter().any(|peer| peer.works())
    }

    /// Waits at most `longest` for a joint state whose program or sequence number differs from `last`; returns `true`
    /// if it arrived.
    pub fn wait_for_state(&self, last: Option<(u64, u64)>, longest: Duration) -> bool {
        let is_new = |inbox: &mut WatchInbox| {
            let state = inbox.state().map(|state| state.header);
            state.is_some_and(|header| Some((header.instance, header.sequence)) != last)
        };
        self.inbox.wait_for(longest, is_new)
    }

    /// Calls `look` with the latest data from programs that are still alive.
    pub fn heard<T>(&self, look: impl FnOnce(&RigMessages) -> T) -> T {
        let inbox = self.inbox.lock();
        look(&RigMessages::new(&inbox, (self.clock)()))
    }

    /// Updates the torque history and the fault.
    pub fn look(&mut self) {
        let inbox = self.inbox.lock();
        let heard = RigMessages::new(&inbox, (self.clock)());
        let time = heard.state.map_or(UNKNOWN, |state| state.header.stamp);
        if let (Some(state), Some(instruments)) = (heard.state, heard.instruments()) {
            if self.torque_of != Some(state.header.instance) {
                self.torque_of = Some(state.header.instance);
                self.torque = History::default();
            }
            self.torque.push(time, instruments.torque);
        }
        let faults = heard.faults();
        // The start time of a fault that existed from the beginning is unknown.
        let began = if self.was_well { time } else { UNKNOWN };
        self.was_well |= heard.mode.is_some() && faults.is_empty();
        self.fault = fault(self.fault.take(), faults, began);
    }

    /// Returns a snapshot of the current state.
    pub fn snapshot(&self) -> Snapshot {
        let (inbox, now) = (self.inbox.lock(), (self.clock)());
        let heard = RigMessages::new(&inbox, now);
        let instruments = heard.instruments();
        let has_cap = self.config.cap().is_some();
        Snapshot {
            title: format!("rig {}", self.rig),
            time: heard.state.map_or(UNKNOWN, |state| state.header.stamp),
            clock: TimeBase::Real,
            task: heard.mode.and_then(|mode| self.task(mode)),
            fingers: self.fingers(&heard),
            torque: instruments.map(|at| Torque {
                newest: at.torque,
                history: self.torque.values(),
                interval: self.torque.interval(),
            }),
            true_cap_angle: instruments.filter(|_| has_cap).map(|at| at.cap_angle),
            programs: programs(inbox.peers(), self.layouts.len(), now),
            fault: self.fault.clone().or_else(|| heard.said()),
            hand_listens: true,
            missed: Some(inbox.missed),
            notice: self.notice(&heard),
        }
    }

    fn task(&self, mode: &HandMode) -> Option<TaskState> {
        Some(TaskState {
            phase: Phase::try_from(mode.phase).ok()?,
            stroke: mode.stroke,
            strokes: Some(self.config.task.strokes()),
        })
    }

    fn fingers(&self, heard: &RigMessages) -> Vec<Finger> {
        let layouts = self.layouts.iter().enumerate();
        let mut joints = heard.positions();
        layouts
            .map(|(number, layout)| {
                let (flags, forces, shear_rates) = match heard.finger(number) {
                    Some((flags, update)) => {
                        let forces = update.valid_forces().collect();
                        (flags, forces, update.shear_rate.clone())
                    }
                    None => nothing_felt(layout.elements.len()),
                };
                Finger {
                    number,
                    flags,
                    thresholds: self.config.control.thresholds(),
                    grasp_target: self.config.task.grasp_force(),
                    elements: layout.elements.clone(),
                    forces,
                    shear_rates,
                    joints: joints.next().unwrap_or_else(|| {
                        let count = heard.inbox.peers().joints().of_finger(number);
                        JointVector::splat(count, UNKNOWN)
                    }),
                }
            })
            .collect()
    }

    fn notice(&self, heard: &RigMessages) -> String {
        let theirs = heard.inbox.experiment();
        if heard.mode.is_some_and(HandMode::is_waiting) {
            "the hand is waiting for other programs".into()
        } else if !theirs.is_empty() && theirs != self.experiment {
            "the rig runs with different settings".into()
        } else {
            String::new()
        }
    }
}

/// Returns the fault to show, given the one shown `before` and the current `faults`. A new fault starts at `now` (s).
fn fault(before: Option<Fault>, faults: Vec<String>, now: f64) -> Option<Fault> {
    if faults.is_empty() {
        return before.map(|fault| Fault {
            over: true,
            ..fault
        });
    }
    // An ongoing fault keeps its start time.
    let began = before.filter(|fault| !fault.over);
    Some(Fault {
        time: began.map_or(now, |fault| fault.time),
        words: faults.join("; "),
        over: false,
    })
}
