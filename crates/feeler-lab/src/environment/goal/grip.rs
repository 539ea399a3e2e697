//! Goal of holding an object with little force while an arm carries it. Rewards are in N·s.
//!
//! Carrying the object earns its weight times the time in the air. Pressing costs a tenth of the fingers' forces times the
//! time. An object that leaves the fingers in the air is dropped, which costs 20 N·s, about what carrying a kilogram for two
//! seconds earns, and ends the episode. The goal is reached once the object has been carried, stands again, and no finger
//! touches it.

use super::carry::pressing;
use super::{Goal, Seen, Verdict, no_goal};
use crate::config::Experiment;
use crate::environment::EnvironmentError;
use feeler::control::task::TaskConfig;
use feeler_sim::objects::Motion;
use feeler_sim::world::World;
use glam::DVec3;

/// Cost per newton and second of the fingers' forces (N·s).
const PRESSING: f64 = 0.1;
/// Cost of dropping the object (N·s).
const DROPPED: f64 = 20.0;
/// Height above the table above which the object counts as in the air (m).
const IN_AIR: f64 = 3e-4;
/// Height above the table above which losing the object counts as dropping it (m).
const DROP: f64 = 4e-3;
/// Height above the table to which the object must be lifted (m).
const LIFTED: f64 = 0.02;

/// The goal of holding an object, with its state in the episode.
#[derive(Debug, Clone, Default)]
pub(super) struct GripGoal {
    approaches: Vec<DVec3>,
    /// Index of the held object.
    object: usize,
    /// Index of the fixed object under the held object.
    table: usize,
    /// Initial difference between the heights of both objects (m).
    standing: f64,
    /// Height of the object above the table (m).
    height: f64,
    /// Maximum height of the object so far (m).
    highest: f64,
    /// Sum of the fingers' pressing forces (N).
    pressing: f64,
    touches: bool,
    /// Time integral of the object's weight while it is in the air (N·s).
    carried: f64,
    /// Time integral of the fingers' pressing forces (N·s).
    pressed: f64,
}

impl GripGoal {
    fn difference(&self, world: &World) -> f64 {
        let objects = &world.state().objects;
        let height = |index: usize| objects.get(index).map_or(0.0, |o| o.pose.position.z);
        height(self.object) - height(self.table)
    }

    fn look(&mut self, world: &World) {
        self.height = self.difference(world) - self.standing;
        self.highest = self.highest.max(self.height);
        let fingers = self.approaches.iter().enumerate();
        let forces =
            fingers.map(|(finger, &approach)| pressing(world, finger, self.object).dot(approach));
        self.pressing = forces.sum();
        let mut contacts = world.state().fingers.iter().flat_map(|f| f.contacts.iter());
        self.touches = contacts.any(|contact| contact.object == self.object);
    }
}

impl Goal for GripGoal {
    fn names(&self) -> &'static [&'static str] {
        &["height_m", "pressing_force_n", "carried_ns", "pressed_ns"]
    }

    fn begin(&mut self, experiment: &Experiment, seen: &Seen<'_>) -> Result<(), EnvironmentError> {
        let TaskConfig::Grip(grip) = &experiment.config.task else {
            return Err(no_goal(experiment));
        };
        let find = |of: fn(&Motion) -> bool| {
            let mut objects = seen.world.model().objects.iter();
            objects
                .position(|object| of(&object.motion))
                .ok_or_else(|| no_goal(experiment))
        };
        let approaches = grip
            .finger
            .iter()
            .map(|finger| DVec3::from_array(finger.approach));
        *self = Self {
            approaches: approaches.map(DVec3::normalize_or_zero).collect(),
            object: find(|motion| matches!(motion, Motion::Free(_)))?,
            table: find(|motion| matches!(motion, Motion::Fixed))?,
            ..Self::default()
        };
        self.standing = self.difference(seen.world);
        self.look(seen.world);
        Ok(())
    }

    fn judge(&mut self, seen: &Seen<'_>) -> Verdict {
        self.look(seen.world);
        let state = &seen.world.state().objects;
        let mass = state.get(self.object).map_or(0.0, |object| object.mass);
        let weight = mass * seen.world.model().gravity.length();
        let carried = match self.height > IN_AIR && self.touches {
            true => weight * seen.period,
            false => 0.0,
        };
        let pressed = self.pressing * seen.period;
        self.carried += carried;
        self.pressed += pressed;
        let dropped = self.height > DROP && !self.touches;
        Verdict {
            reward: carried - PRESSING * pressed - if dropped { DROPPED } else { 0.0 },
            over: dropped || self.reached(),
        }
    }

    fn reached(&self) -> bool {
        self.highest > LIFTED && self.height <= IN_AIR && !self.touches
    }

    fn tell(&self, values: &mut [f64]) {
        values.copy_from_slice(&[self.height, self.pressing, self.carried, self.pressed]);
    }
}
