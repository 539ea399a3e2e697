//! The physical limit: the largest torque that circular paths about the cap's true axis reach without overload.

use super::{AnyError, Outcome, Variant, outcome};
use feeler::control::law::Law;
use feeler::control::task::screw::ScrewConfig;
use feeler::control::task::{Task, TaskConfig};
use feeler::control::{FingerReadings, HandReadings, Phase, Plan, StopReason};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Pictures, Session};
use glam::DVec3;

/// Range of radii searched for the smallest circle without overload (m): from fingertips that nearly meet the axis to
/// fingertips that do not touch the cap.
const RADII: (f64, f64) = (0.024, 0.037);
/// Number of bisections, which give a resolution of 25 µm.
const HALVINGS: usize = 9;
/// Gain of the radius controller: speed per distance from the circle (1/s).
const GAIN: f64 = 8.0;

/// Returns the largest torque (N·m), or `None` if every circle overloads an element.
pub fn largest_torque(experiment: &Experiment) -> Result<Option<f64>, AnyError> {
    let (mut deep, mut shallow) = RADII;
    let mut most = None;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (deep + shallow);
        let outcome = on_circle(experiment, middle)?;
        if outcome.unharmed {
            (shallow, most) = (middle, Some(outcome.torque));
        } else {
            deep = middle;
        }
    }
    Ok(most.filter(|torque| *torque > 0.0))
}

/// Runs the experiment with fingertips that move around the cap's true axis at `radius` (m).
fn on_circle(experiment: &Experiment, radius: f64) -> Result<Outcome, AnyError> {
    let TaskConfig::Screw(config) = &experiment.config.task else {
        return Err("expected an experiment with [task.screw]".into());
    };
    let homes: Vec<_> = config.finger.iter().map(|finger| finger.home).collect();
    let world = Session::rendering(experiment, Pictures::Sensed)?;
    let (world, cap) = (world.rig().world(), "cap");
    let index = world.model().object(cap).ok_or("expected a cap")?;
    let task = Circle {
        axis: world.state().objects[index].pose.position,
        radius,
        config: config.clone(),
        phase: Phase::Search,
        stroke: 1,
        starts: Vec::new(),
    };
    let mut session =
        Session::with_task_rendering(experiment, Box::new(task), &homes, Pictures::Sensed)?;
    session.set_laws(|_| Box::new(AsPlanned));
    outcome(&mut session, experiment, Variant::Middle)
}

/// A law that follows the plan without changes.
#[derive(Debug, Clone)]
struct AsPlanned;

impl Law for AsPlanned {
    fn velocity(&mut self, plan: &Plan, _: &FingerReadings<'_>) -> DVec3 {
        plan.velocity
    }
}

/// A screw task with circular strokes about a known axis.
#[derive(Debug, Clone)]
struct Circle {
    config: ScrewConfig,
    axis: DVec3,
    radius: f64,
    phase: Phase,
    stroke: u32,
    starts: Vec<DVec3>,
}

impl Circle {
    fn off_axis(&self, position: DVec3) -> DVec3 {
        (position - self.axis).with_z(0.0)
    }

    fn all(&self, hand: &HandReadings<'_>, holds: impl Fn(usize, DVec3) -> bool) -> bool {
        let fingers = hand.poses.iter().enumerate();
        fingers
            .into_iter()
            .all(|(finger, pose)| holds(finger, pose.position))
    }
}

impl Task for Circle {
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        let config = &self.config;
        let (home, approach, stroke) = (
            |finger: usize| DVec3::from(config.finger[finger].home),
            |finger: usize| DVec3::from(config.finger[finger].approach),
            |finger: usize| DVec3::from(config.finger[finger].stroke),
        );
        let arrived = |_: usize, at: DVec3| self.off_axis(at).length() <= self.radius + 2e-5;
        let travelled = |finger: usize, at: DVec3| {
            (at - self.starts[finger]).dot(stroke(finger)) >= config.travel
        };
        let detached = |finger: usize, at: DVec3| (at - home(finger)).dot(approach(finger)) <= 0.0;
        let at_home = |finger: usize, at: DVec3| at.distance(home(finger)) <= config.home_tolerance;
        match self.phase {
            Phase::Search if self.all(hand, arrived) => {
                self.starts = hand.poses.iter().map(|pose| pose.position).collect();
                self.phase = Phase::Move;
            }
            Phase::Move if self.all(hand, travelled) => self.phase = Phase::Release,
            Phase::Release if self.all(hand, detached) => self.phase = Phase::Return,
            Phase::Return if self.all(hand, at_home) && self.stroke < config.strokes => {
                self.stroke += 1;
                self.phase = Phase::Search;
            }
            Phase::Return if self.all(hand, at_home) => self.phase = Phase::Done,
            _ => {}
        }
        Ok(())
    }

    fn plan(&self, finger: usize, hand: &HandReadings<'_>) -> Plan {
        let path = &self.config.finger[finger];
        let (approach, stroke) = (DVec3::from(path.approach), DVec3::from(path.stroke));
        let position = hand.poses[finger].position;
        let outward = self.off_axis(position).normalize();
        let error = self.off_axis(position).length() - self.radius;
        let velocity = match self.phase {
            Phase::Search => (GAIN * error).clamp(-0.004, 0.004) * approach,
            Phase::Move if (position - self.starts[finger]).dot(stroke) < self.config.travel => {
                let tangent = stroke.reject_from_normalized(outward).normalize();
                self.config.move_speed * tangent - GAIN * error * outward
            }
            Phase::Release => -self.config.return_speed * approach,
            Phase::Return => {
                let way = DVec3::from(path.home) - position;
                (GAIN * way).clamp_length_max(self.config.return_speed)
            }
            _ => DVec3::ZERO,
        };
        Plan {
            velocity,
            towards_object: approach,
            reflex: false,
            keep_grasp: false,
        }
    }

    fn phase(&self) -> Phase {
        self.phase
    }

    fn stroke(&self) -> u32 {
        self.stroke
    }
}
