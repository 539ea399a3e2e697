//! Goal of tracing the whole outline of an object. Rewards are in percent of its length.
//!
//! A part of the outline counts when the finger passes it for the first time in the episode while the force on the
//! object is between 0.5 and 1.5 times the task's `contact_force`. Below this band contact is not reliable; above it
//! the finger presses instead of following the outline. The potential is the fraction of the outline that has been
//! traced. Force above the band costs 10 % per newton and second. The episode ends when 99 % are traced, because the
//! dome may not fit into a corner.

use super::{Goal, Seen, Verdict, no_goal};
use crate::config::Experiment;
use crate::environment::EnvironmentError;
use crate::experiment::true_section;
use feeler::control::task::TaskConfig;
use feeler_sim::objects::ObjectConfig;
use feeler_sim::world::World;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Minimum and maximum force that counts, relative to the contact force.
const BAND: (f64, f64) = (0.5, 1.5);
/// Cost per newton above the band and per second (%).
const OVERLOAD: f64 = 10.0;
/// Fraction of the outline at which the goal is reached.
const WHOLE: f64 = 0.99;
/// Maximum fraction of the outline passed in one step. A larger one is a jump and does not count.
const MAX_AT_ONCE: f64 = 0.05;

/// The goal of tracing an outline, with its state in the episode.
#[derive(Debug, Clone, Default)]
pub(super) struct ContourGoal {
    /// Object of the cached outline, and height of the outline (m).
    of: Option<(ObjectConfig, f64)>,
    centre: DVec2,
    parts: Vec<Part>,
    contact_force: f64,
    /// Part at the finger's position in the previous step, if the force was in the band.
    last: Option<usize>,
    covered: f64,
    force: f64,
}

#[derive(Debug, Clone, Copy)]
struct Part {
    /// Fraction of the outline's length.
    share: f64,
    felt: bool,
}

impl ContourGoal {
    /// Computes the outline of the episode's object, which is slow, unless it is cached from the previous episode.
    fn take_outline(
        &mut self,
        experiment: &Experiment,
        height: f64,
    ) -> Result<(), EnvironmentError> {
        let objects = experiment
            .config
            .sim
            .iter()
            .flat_map(|sim| sim.object.values());
        let same =
            |(of, at): &(ObjectConfig, f64)| *at == height && objects.clone().any(|o| o == of);
        if self.of.as_ref().is_some_and(same) {
            return Ok(());
        }
        let (object, outline) =
            true_section(&experiment.config).ok_or_else(|| no_goal(experiment))?;
        self.centre = DVec3::from_array(object.position).truncate();
        self.of = Some((object.clone(), height));
        let following = outline.iter().cycle().skip(1);
        let lengths = outline.iter().zip(following);
        let lengths: Vec<f64> = lengths
            .map(|(a, b)| DVec2::from_array(*a).distance(DVec2::from_array(*b)))
            .collect();
        let whole: f64 = lengths.iter().sum();
        let part = |length: f64| Part {
            share: length / whole,
            felt: false,
        };
        self.parts = lengths.into_iter().map(part).collect();
        Ok(())
    }

    /// Returns the part of the outline at the contact, and the horizontal force on the object (N). `None` without
    /// contact.
    fn touched(&self, world: &World) -> Option<(usize, f64)> {
        let finger = world.state().fingers.first()?;
        let (mut force, mut weight, mut middle) = (DVec3::ZERO, 0.0, DVec2::ZERO);
        for contact in finger.contacts.iter() {
            let object = world.state().objects.get(contact.object)?;
            let pushed = finger.forces[contact.element];
            let point = object.pose.to_world(contact.anchor.position).truncate();
            force += pushed;
            weight += pushed.length();
            middle += pushed.length() * point;
        }
        let angle = (middle / weight - self.centre).to_angle();
        let turn = angle.rem_euclid(TAU) / TAU;
        // Not a number without contact.
        if !turn.is_finite() {
            return None;
        }
        let part = (turn * self.parts.len() as f64) as usize;
        Some((part.min(self.parts.len() - 1), force.truncate().length()))
    }

    /// Marks the parts from `from` to `to` as traced, in the shorter direction. Returns the fraction that is newly
    /// traced.
    fn feel(&mut self, from: usize, to: usize) -> f64 {
        let count = self.parts.len();
        let (ahead, back) = ((to + count - from) % count, (from + count - to) % count);
        let (first, steps) = if ahead <= back {
            (from, ahead)
        } else {
            (to, back)
        };
        if steps as f64 > MAX_AT_ONCE * count as f64 {
            return 0.0;
        }
        let mut new = 0.0;
        for part in first..=first + steps {
            let part = &mut self.parts[part % count];
            new += if part.felt { 0.0 } else { part.share };
            part.felt = true;
        }
        new
    }
}

impl Goal for ContourGoal {
    fn names(&self) -> &'static [&'static str] {
        &["outline_felt", "contact_force_n"]
    }

    fn begin(&mut self, experiment: &Experiment, seen: &Seen<'_>) -> Result<(), EnvironmentError> {
        let TaskConfig::Contour(contour) = &experiment.config.task else {
            return Err(no_goal(experiment));
        };
        self.take_outline(experiment, contour.home[2])?;
        for part in &mut self.parts {
            part.felt = false;
        }
        self.contact_force = contour.contact_force;
        (self.last, self.covered) = (None, 0.0);
        self.judge(seen);
        Ok(())
    }

    fn judge(&mut self, seen: &Seen<'_>) -> Verdict {
        let touched = self.touched(seen.world);
        self.force = touched.map_or(0.0, |(_, force)| force);
        let (low, high) = (BAND.0 * self.contact_force, BAND.1 * self.contact_force);
        let within = touched.filter(|(_, force)| (low..=high).contains(force));
        let here = within.map(|(part, _)| part);
        let new = match (self.last, here) {
            (Some(from), Some(to)) => self.feel(from, to),
            _ => 0.0,
        };
        self.last = here;
        self.covered += new;
        let overload = OVERLOAD * (self.force - high).max(0.0) * seen.period;
        Verdict {
            reward: 100.0 * new - overload,
            over: self.reached(),
        }
    }

    fn reached(&self) -> bool {
        self.covered >= WHOLE
    }

    fn tell(&self, values: &mut [f64]) {
        values.copy_from_slice(&[self.covered, self.force]);
    }
}
