//! `feeler ros2 RECORDING`: replays a recording in real time.

use super::diagnostics::status;
use super::graph::{GraphOptions, NODE_NAME, PeerWatch, config, serve_settings};
use super::stamps::time_of_day;
use feeler::control::FingerFlags;
use feeler_console::{CommandError, Outcome, watch_for_interrupt};
use feeler_lab::config::Experiment;
use feeler_record::reading::{FingerStep, Step, Steps};
use feeler_record::ros::Time;
use feeler_record::{NO_ELEMENT, Recording};
use feeler_ros2::message::{DiagnosticLevel, KeyValue};
use feeler_ros2::{HandMessages, HandPublishers, Node, NodeError, Touch};
use glam::DVec3;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Maximum delay in reacting to Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(50);
/// Interval between diagnostics, in the recording's time (s).
const DIAGNOSTICS_INTERVAL: f64 = 1.0;

/// Publishes the recording at `path`, at `speed` times real time, until it ends or until Ctrl-C.
///
/// # Errors
/// If the recording cannot be read, the speed is not positive, or the node cannot be opened.
pub fn publish_recording(
    path: &Path,
    graph: &GraphOptions,
    use_sim_time: bool,
    speed: f64,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    if !(speed.is_finite() && speed > 0.0) {
        return Err(format!("--speed: expected a number above 0, got {speed}").into());
    }
    let graph = config(graph, NODE_NAME)?;
    let recording = Recording::read(path)?;
    let messages = HandMessages::new(&recording.facts)?;
    let experiment =
        Experiment::parse(&recording.experiment, "the recorded experiment", &[], None)?;
    let interrupted = watch_for_interrupt()?;
    let company = PeerWatch::new(&graph);
    let mut node = Node::open(graph)?;
    let publishers = HandPublishers::new(&mut node, messages.fingers.len(), use_sim_time)?;
    serve_settings(&mut node, &experiment, use_sim_time)?;
    writeln!(out, "{} is the ROS 2 node {}", path.display(), node.name())?;
    out.flush()?;
    let mut replay = Replay {
        node,
        company,
        slip_threshold: recording.facts.slip_threshold,
        seen: vec![None; messages.fingers.len()],
        messages,
        publishers,
        times: Times {
            first: recording.task.first().map_or(0.0, |task| task.stamp),
            speed,
            began: (!use_sim_time).then(time_of_day),
        },
        forces: Vec::new(),
        told: f64::NEG_INFINITY,
    };
    Ok(match replay.play(&recording, &interrupted)? {
        true => Outcome::Done,
        false => Outcome::GivenUp,
    })
}

/// Conversion from the recording's time to ROS time.
struct Times {
    /// Time of the recording's first step (s).
    first: f64,
    speed: f64,
    /// Start of the replay (s since 1970), or `None` if stamps are in the recording's time.
    began: Option<f64>,
}

impl Times {
    /// Returns the delay (s) from the start of the replay until `time` is due.
    fn due(&self, time: f64) -> f64 {
        (time - self.first) / self.speed
    }

    fn stamp(&self, time: f64) -> Option<Time> {
        Time::of(self.began.map_or(time, |began| began + self.due(time)))
    }
}

/// State of a replay.
struct Replay {
    node: Node,
    company: PeerWatch,
    messages: HandMessages,
    publishers: HandPublishers,
    times: Times,
    slip_threshold: f64,
    /// Sequence number of the last published frame of each finger.
    seen: Vec<Option<u64>>,
    /// Reused buffer.
    forces: Vec<DVec3>,
    /// Time of the latest diagnostics, in the recording's time (s).
    told: f64,
}

impl Replay {
    /// Publishes each step when it is due; returns `false` if interrupted.
    fn play(&mut self, recording: &Recording, interrupted: &AtomicBool) -> Result<bool, NodeError> {
        let began = Instant::now();
        for (number, step) in Steps::new(recording).enumerate() {
            let due = self.times.due(step.task.stamp);
            let due = Duration::try_from_secs_f64(due).unwrap_or_default();
            while let Some(left) = due
                .checked_sub(began.elapsed())
                .filter(|left| !left.is_zero())
            {
                if interrupted.load(Ordering::Relaxed) {
                    return Ok(false);
                }
                thread::sleep(left.min(PATIENCE));
            }
            self.publish(&step, number == 0)?;
        }
        Ok(true)
    }

    fn publish(&mut self, step: &Step, is_first: bool) -> Result<(), NodeError> {
        let Some(stamp) = self.times.stamp(step.task.stamp) else {
            return Ok(());
        };
        if is_first {
            self.messages.kinematics.set_still(stamp);
            self.publishers.publish_still(&self.messages)?;
        }
        self.publish_joints(step)?;
        for (finger, of_finger) in step.fingers.iter().enumerate() {
            self.publish_finger(finger, of_finger)?;
        }
        if step.task.stamp - self.told >= DIAGNOSTICS_INTERVAL {
            self.told = step.task.stamp;
            let phase = step.task.phase.to_string();
            let values = [
                ("phase", phase.clone()),
                ("stroke", step.task.stroke.to_string()),
            ];
            let values = values.map(|(key, value)| KeyValue {
                key: key.into(),
                value,
            });
            self.company.look(&self.node);
            let name = format!("{}: recording", self.node.name());
            let status = status(DiagnosticLevel::Ok, name, phase, values.into());
            self.publishers.publish_diagnostics(stamp, vec![status])?;
        }
        Ok(())
    }

    fn publish_joints(&mut self, step: &Step) -> Result<(), NodeError> {
        let joints = step.fingers.iter().filter_map(|finger| finger.joints);
        // All joints are read at once.
        let stamp = joints
            .clone()
            .next()
            .and_then(|joints| self.times.stamp(joints.stamp));
        let Some(stamp) = stamp.filter(|_| joints.clone().count() == step.fingers.len()) else {
            return Ok(());
        };
        let joints = joints.map(|j| (j.position, j.velocity));
        self.messages.set_joints(stamp, joints);
        self.publishers.publish_joints(&self.messages)
    }

    fn publish_finger(&mut self, finger: usize, step: &FingerStep) -> Result<(), NodeError> {
        let (Some(tactile), Some(flags)) = (step.tactile, step.flags) else {
            return Ok(());
        };
        let Some(messages) = self.messages.fingers.get_mut(finger) else {
            return Ok(());
        };
        let Some(stamp) = self.times.stamp(tactile.stamp) else {
            return Ok(());
        };
        if self.seen[finger].replace(tactile.sequence) == Some(tactile.sequence) {
            return Ok(());
        }
        self.forces.clear();
        self.forces
            .extend(tactile.forces.iter().map(|&force| DVec3::from(force)));
        let largest = (flags.largest_element != NO_ELEMENT).then_some(flags.largest_element);
        let touch = Touch {
            sequence: tactile.sequence,
            flags: &FingerFlags {
                touch: flags.touch,
                slip: flags.slip,
                over: flags.over,
                largest_element: largest.and_then(|element| usize::try_from(element).ok()),
                grasp_force: flags.grasp_force,
            },
            forces: &self.forces,
            shear_rate: &flags.shear_rate,
            slip_threshold: self.slip_threshold,
        };
        messages.set(stamp, &touch);
        self.publishers.publish_finger(finger, messages)
    }
}
