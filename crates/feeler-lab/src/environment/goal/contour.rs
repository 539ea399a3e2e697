//! An outline that is to be felt all the way round. Rewards are in percent of its length.
//!
//! What counts is outline that the finger has not been at before in this episode, and that it passes while the force on the object is
//! within half and one and a half times the task's `contact_force`: where it is less, nothing is felt for sure, and where it is
//! more, the finger does not feel its way but pushes. That is a potential, too: the part of the outline that has been felt. Force
//! above the band costs 10 % for each newton and second. The episode ends when 99 % are felt: a corner that the dome cannot get into
//! shall not keep it going.

use super::{Goal, Seen, Verdict, no_goal};
use crate::config::Experiment;
use crate::environment::EnvironmentError;
use crate::experiment::true_section;
use feeler::control::task::TaskConfig;
use feeler_sim::object::ObjectConfig;
use feeler_sim::world::World;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Lowest and highest force that counts, as a share of the contact force.
const BAND: (f64, f64) = (0.5, 1.5);
/// Of a newton above the band for a second, %.
const OVERLOAD: f64 = 10.0;
/// The outline is felt with so much of it.
const WHOLE: f64 = 0.99;
/// Between two steps the finger passes no more than this part of the outline; more is a jump, of which nothing was felt.
const MOST_AT_ONCE: f64 = 0.05;

/// The goal, with its memory.
#[derive(Debug, Clone, Default)]
pub(super) struct ContourGoal {
    /// The object that the outline is of, its place, and the outline's parts by their angle about the object's origin.
    of: Option<(ObjectConfig, f64)>,
    centre: DVec2,
    parts: Vec<Part>,
    contact_force: f64,
    /// The part that the finger was at in the step before, if its force was in the band.
    last: Option<usize>,
    covered: f64,
    force: f64,
}

#[derive(Debug, Clone, Copy)]
struct Part {
    /// Of the whole outline's length.
    share: f64,
    felt: bool,
}

impl ContourGoal {
    /// Takes the outline of the episode's object, unless it is the one before's: it takes a while to find.
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

    /// The part of the outline where the finger touches, and its force on the object, N, horizontally.
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
        // Not a number where nothing touches.
        if !turn.is_finite() {
            return None;
        }
        let part = (turn * self.parts.len() as f64) as usize;
        Some((part.min(self.parts.len() - 1), force.truncate().length()))
    }

    /// Takes the parts from `from` to `to` as felt, the shorter way round; the share of those that were not before.
    fn feel(&mut self, from: usize, to: usize) -> f64 {
        let count = self.parts.len();
        let (ahead, back) = ((to + count - from) % count, (from + count - to) % count);
        let (first, steps) = if ahead <= back {
            (from, ahead)
        } else {
            (to, back)
        };
        if steps as f64 > MOST_AT_ONCE * count as f64 {
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
