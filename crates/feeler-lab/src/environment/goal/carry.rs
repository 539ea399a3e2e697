//! Goal of moving an object along a path. Rewards are in mm.
//!
//! The potential is the object's progress along the path: the length of the path minus the remaining length, which is
//! measured in a straight line to the next waypoint and along the path from there. A waypoint is reached within 2 mm,
//! and passed once the object has been held there for the waypoint's duration; if the object leaves early, the
//! duration starts again. Dropping a lifted object loses the reward that lifting it gained.
//!
//! A finger that presses the object harder than `crush_force` costs 10 mm per newton and second. An object that falls
//! off its support or tips over is lost, which costs 20 mm, about the length of a path, and ends the episode. The end
//! of the path ends the episode, too.

use super::{Goal, Seen, Verdict, no_goal};
use crate::config::Experiment;
use crate::environment::EnvironmentError;
use feeler::control::task::TaskConfig;
use feeler::control::task::carry::CarryConfig;
use feeler_sim::objects::{Motion, Pose};
use feeler_sim::world::World;
use glam::DVec3;

/// Maximum distance from a waypoint at which it is reached (m).
const REACHED: f64 = 0.002;
/// Cost per newton above the crushing force and per second (mm).
const CRUSH: f64 = 10.0;
/// Cost of losing the object (mm).
const LOST: f64 = 20.0;
/// Distance below the lowest waypoint at which the object counts as fallen (m).
const FALL: f64 = 0.005;
/// Cosine of the tilt angle above which the object has tipped over: 45 degrees.
const TIPPED: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The goal of moving an object, with its state in the episode.
#[derive(Debug, Clone, Default)]
pub(super) struct CarryGoal {
    waypoints: Vec<Waypoint>,
    /// Direction in which each finger presses, a unit vector in W.
    approaches: Vec<DVec3>,
    crush_force: f64,
    /// Index of the carried object.
    object: usize,
    /// Initial pose of the carried object.
    start: Option<Pose>,
    /// Index of the next waypoint.
    next: usize,
    /// Time for which the object has been at the next waypoint (s).
    held: f64,
    /// Displacement of the carried object in W (m).
    moved: DVec3,
    /// Remaining length of the path (m).
    left: f64,
    /// Largest force of any finger on the object (N).
    pressing: f64,
}

#[derive(Debug, Clone, Copy)]
struct Waypoint {
    to: DVec3,
    /// Duration for which the object must stay at the waypoint (s).
    hold: f64,
    /// Length of the path from this waypoint to the end of the path (m).
    rest: f64,
}

/// Converts a path to waypoints with the remaining length after each one.
fn path(config: &CarryConfig) -> Vec<Waypoint> {
    let mut path: Vec<Waypoint> = Vec::with_capacity(config.waypoint.len());
    for waypoint in config.waypoint.iter().rev() {
        let (to, hold) = (DVec3::from_array(waypoint.to), waypoint.hold);
        let rest = path
            .last()
            .map_or(0.0, |next| next.rest + next.to.distance(to));
        path.push(Waypoint { to, hold, rest });
    }
    path.reverse();
    path
}

impl CarryGoal {
    /// Updates the object's position, the remaining path and the pressing force.
    fn look(&mut self, world: &World) {
        let (Some(object), Some(start)) = (world.state().objects.get(self.object), self.start)
        else {
            return;
        };
        self.moved = object.pose.position - start.position;
        self.left = match self.waypoints.get(self.next) {
            Some(next) => next.to.distance(self.moved) + next.rest,
            None => 0.0,
        };
        let pressed = self.approaches.iter().enumerate();
        let pressed =
            pressed.map(|(finger, &approach)| pressing(world, finger, self.object).dot(approach));
        self.pressing = pressed.fold(0.0, f64::max);
    }

    /// Advances to the next waypoint if the object has been held at the current one for long enough.
    fn go_on(&mut self, period: f64) {
        let Some(next) = self.waypoints.get(self.next) else {
            return;
        };
        if next.to.distance(self.moved) > REACHED {
            self.held = 0.0;
            return;
        }
        self.held += period;
        if self.held >= next.hold {
            self.next += 1;
            self.held = 0.0;
        }
    }

    fn is_lost(&self, world: &World) -> bool {
        let now = world
            .state()
            .objects
            .get(self.object)
            .map(|object| object.pose);
        let (Some(now), Some(start)) = (now, self.start) else {
            return false;
        };
        let upright = start.rotation.transpose() * DVec3::Z;
        let lowest = self
            .waypoints
            .iter()
            .map(|waypoint| waypoint.to.z)
            .fold(0.0, f64::min);
        self.moved.z < lowest - FALL || (now.rotation * upright).z < TIPPED
    }
}

/// Force of `finger` on `object` in W (N).
pub(super) fn pressing(world: &World, finger: usize, object: usize) -> DVec3 {
    let Some(finger) = world.state().fingers.get(finger) else {
        return DVec3::ZERO;
    };
    let contacts = finger
        .contacts
        .iter()
        .filter(|contact| contact.object == object);
    contacts.map(|contact| finger.forces[contact.element]).sum()
}

impl Goal for CarryGoal {
    fn names(&self) -> &'static [&'static str] {
        &[
            "path_left_m",
            "object_x_m",
            "object_y_m",
            "object_z_m",
            "pressing_force_n",
        ]
    }

    fn begin(&mut self, experiment: &Experiment, seen: &Seen<'_>) -> Result<(), EnvironmentError> {
        let TaskConfig::Carry(carry) = &experiment.config.task else {
            return Err(no_goal(experiment));
        };
        let mut objects = seen.world.model().objects.iter();
        let free = objects.position(|object| matches!(object.motion, Motion::Free(_)));
        let object = free.ok_or_else(|| no_goal(experiment))?;
        let approaches = carry.finger.iter().map(|finger| finger.approach);
        *self = Self {
            waypoints: path(carry),
            approaches: approaches
                .map(|approach| DVec3::from_array(approach).normalize_or_zero())
                .collect(),
            crush_force: carry.crush_force,
            object,
            start: seen
                .world
                .state()
                .objects
                .get(object)
                .map(|object| object.pose),
            ..Self::default()
        };
        self.look(seen.world);
        Ok(())
    }

    fn judge(&mut self, seen: &Seen<'_>) -> Verdict {
        let left = self.left;
        self.look(seen.world);
        let gained = 1e3 * (left - self.left);
        let crushed = CRUSH * (self.pressing - self.crush_force).max(0.0) * seen.period;
        let reward = gained - crushed;
        if self.is_lost(seen.world) {
            return Verdict {
                reward: reward - LOST,
                over: true,
            };
        }
        self.go_on(seen.period);
        Verdict {
            reward,
            over: self.reached(),
        }
    }

    fn reached(&self) -> bool {
        self.next == self.waypoints.len()
    }

    fn tell(&self, values: &mut [f64]) {
        let DVec3 { x, y, z } = self.moved;
        values.copy_from_slice(&[self.left, x, y, z, self.pressing]);
    }
}
