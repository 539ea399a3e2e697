//! `feeler ros2 RIG`: publishes a running networked rig.

use super::diagnostics::diagnostics;
use super::graph::{GraphOptions, NODE_NAME, PeerWatch, check_ports, config, serve_settings};
use super::orders::serve_orders;
use super::stamps::{Stamps, time_of_day};
use crate::session::RigSession;
use feeler_console::{CommandError, Outcome, watch_for_interrupt};
use feeler_lab::experiment::run_facts;
use feeler_link::hand::HandClient;
use feeler_link::messages::message::MessageHeader;
use feeler_link::security::Right;
use feeler_record::ros::Time;
use feeler_ros2::{HandMessages, HandPublishers, Node, NodeError, Touch};
use feeler_watch::WatchedRig;
use glam::DVec3;
use std::io::Write;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Maximum delay in reacting to Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(50);
/// Interval between diagnostics.
const DIAGNOSTICS_INTERVAL: Duration = Duration::from_secs(1);

/// Publishes the rig of `session` as a node until Ctrl-C.
///
/// # Errors
/// If the network or the node cannot be opened, or one of them fails.
pub fn publish_rig(
    session: &RigSession,
    graph: &GraphOptions,
    use_sim_time: bool,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let graph = config(graph, NODE_NAME)?;
    check_ports(&graph, &session.link.endpoints())?;
    let (experiment, rig) = (&session.experiment, &session.name);
    let facts = run_facts(&experiment.config)?;
    let messages = HandMessages::new(&facts)?;
    let network = session.connect(&[Right::Order, Right::Watch])?;
    let watched = WatchedRig::new(experiment, rig, network.clone())?;
    let interrupted = watch_for_interrupt()?;
    let company = PeerWatch::new(&graph);
    let mut node = Node::open(graph)?;
    let publishers = HandPublishers::new(&mut node, messages.fingers.len(), use_sim_time)?;
    serve_settings(&mut node, experiment, use_sim_time)?;
    serve_orders(&mut node, HandClient::new(network)?)?;
    writeln!(out, "rig {rig} is the ROS 2 node {}", node.name())?;
    out.flush()?;
    let mut published = RigNode {
        node,
        company,
        slip_threshold: facts.slip_threshold,
        seen: vec![None; messages.fingers.len()],
        messages,
        publishers,
        stamps: Stamps::new(use_sim_time),
        state: None,
        forces: Vec::new(),
        now: None,
    };
    published.publish_until(watched, || interrupted.load(Ordering::Relaxed))?;
    Ok(Outcome::Done)
}

/// State of a published rig.
struct RigNode {
    node: Node,
    company: PeerWatch,
    messages: HandMessages,
    publishers: HandPublishers,
    stamps: Stamps,
    slip_threshold: f64,
    /// Program instance and sequence number of the last published state.
    state: Option<(u64, u64)>,
    /// Program instance and sequence number of the last published update of each finger.
    seen: Vec<Option<(u64, u64)>>,
    /// Reused buffer.
    forces: Vec<DVec3>,
    /// Time of the latest state.
    now: Option<Time>,
}

impl RigNode {
    fn publish_until(
        &mut self,
        mut watched: WatchedRig,
        is_over: impl Fn() -> bool,
    ) -> Result<(), NodeError> {
        let mut told = Instant::now();
        while !is_over() {
            watched.wait_for_state(self.state, PATIENCE);
            let has_begun = self.now.is_some();
            watched.heard(|heard| self.take(heard))?;
            if !has_begun && let Some(now) = self.now {
                self.messages.kinematics.set_still(now);
                self.publishers.publish_still(&self.messages)?;
            }
            if told.elapsed() >= DIAGNOSTICS_INTERVAL {
                told = Instant::now();
                watched.look();
                let stamp = match &self.stamps {
                    Stamps::OfTheRun => self.now,
                    Stamps::OfTheDay(_) => Time::of(time_of_day()),
                };
                self.company.look(&self.node);
                let name = self.node.name().to_string();
                let status = diagnostics(&watched.snapshot(), &name);
                self.publishers
                    .publish_diagnostics(stamp.unwrap_or_default(), status)?;
            }
        }
        Ok(())
    }

    /// Publishes the data that are new since the last call.
    fn take(&mut self, heard: &feeler_watch::RigMessages) -> Result<(), NodeError> {
        let arrived = time_of_day();
        let number = |header: MessageHeader| Some((header.instance, header.sequence));
        if let Some(state) = heard
            .state
            .filter(|state| number(state.header) != self.state)
        {
            self.state = number(state.header);
            if let Some(stamp) = self
                .stamps
                .of(state.header.clock, state.header.stamp, arrived)
            {
                self.now = Some(stamp);
                let joints = heard.positions().zip(heard.velocities());
                self.messages.set_joints(stamp, joints);
                self.publishers.publish_joints(&self.messages)?;
            }
        }
        for (finger, messages) in self.messages.fingers.iter_mut().enumerate() {
            let Some((flags, update)) = heard.finger(finger) else {
                continue;
            };
            if number(update.header) == self.seen[finger] {
                continue;
            }
            self.seen[finger] = number(update.header);
            let Some(stamp) = self
                .stamps
                .of(update.header.clock, update.header.stamp, arrived)
            else {
                continue;
            };
            self.forces.clear();
            self.forces.extend(update.valid_forces());
            let touch = Touch {
                sequence: update.frame,
                flags: &flags,
                forces: &self.forces,
                shear_rate: &update.shear_rate,
                slip_threshold: self.slip_threshold,
            };
            messages.set(stamp, &touch);
            self.publishers.publish_finger(finger, messages)?;
        }
        Ok(())
    }
}
