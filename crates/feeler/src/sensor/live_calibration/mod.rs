//! Guides through loading a fingertip that stands on a six-axis force sensor: from pictures and forces as they come in to the samples
//! that a calibration is fitted to ([`fit`](super::calibration_fit::fit)).
//!
//! 1. **Untouched**: what forces and pictures are without load.
//! 2. **Presses**: how much later than the force the picture of it comes in, by the correlation of both.
//! 3. **Loads**: each picture in which one element alone is touched is a sample of that element, if forces like it are still missing
//!    and the force does not change so fast that the delay's rest matters.
//!
//! Times are of arrival, on one clock. Forces are those on the fingertip by what touches it.

mod axes;
mod contact;
mod coverage;
mod delay;

pub use axes::{AxesError, ForceAxes};
pub use coverage::{Coverage, Goal, Missing};
pub use delay::Delay;

use super::moments::ElementMoments;
use contact::{Contact, Untouched};
use delay::{Timed, between};
use glam::{DMat3, DVec3};
use std::collections::VecDeque;

/// Pictures without load that the untouched fingertip is known by.
const UNTOUCHED_PICTURES: usize = 16;
/// Forces are kept for so long, s.
const KEPT: f64 = 20.0;
/// Correlation of pictures and forces from which a delay is taken for true.
const CORRELATED: f64 = 0.9;
/// Presses from which the delay is looked for. Of whole ones: pictures do not grow in proportion to forces, which while only one
/// side of a press is known looks like a delay.
const PRESSES: u32 = 3;
/// Largest change of a sample's force, full scales per second, and the time over which it is taken, s.
const FASTEST: f64 = 2.0;
const CHANGE_TIME: f64 = 0.02;
/// The tare follows the untouched sensor with this time constant, s.
const TARE_TIME: f64 = 2.0;

/// How far it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stage {
    /// So many pictures without load are still missing.
    Untouched {
        /// Pictures.
        missing: usize,
    },
    /// Presses, each with a release, show the delay.
    Presses {
        /// So many are still missing, unless pictures and forces do not go together.
        missing: u32,
        /// What is found so far, if anything.
        found: Option<Delay>,
    },
    /// Elements are loaded.
    Loads,
}

/// What a picture was good for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Seen {
    /// It is one of the untouched fingertip, which all elements are to know.
    Untouched,
    /// One of the presses, or while nothing is touched.
    Nothing,
    /// Several elements are touched, or the force is gone too fast or not known at its time.
    Unclear,
    /// More than the goal, or as many like it are there as are kept.
    Enough {
        /// The element that is touched.
        element: usize,
        /// Force on it in its frame, N.
        force: DVec3,
    },
    /// A sample to keep.
    Sample {
        /// The element that is touched.
        element: usize,
        /// Force on it in its frame, N.
        force: DVec3,
    },
}

/// The state of a live calibration.
#[derive(Debug)]
pub struct LiveCalibration {
    /// Rotation of each element's frame in the fingertip's.
    frames: Vec<DMat3>,
    goal: Goal,
    coverage: Vec<Coverage>,
    untouched_pictures: Vec<Vec<ElementMoments>>,
    untouched: Option<Untouched>,
    /// Time and force on the fingertip, in its frame, with the tare in it.
    forces: VecDeque<(f64, DVec3)>,
    /// Sum and number of the forces without load, then the tare.
    tare: DVec3,
    tared: u32,
    /// How much pictures changed, while the delay is looked for.
    changes: Vec<Timed>,
    delay: Option<Delay>,
    /// Presses that have ended.
    presses: u32,
    /// Whether the newest picture showed nothing touched.
    is_free: bool,
}

impl LiveCalibration {
    /// Of a fingertip whose elements' frames are so in its own frame, with as much known of each as `coverage` says.
    pub fn new(frames: Vec<DMat3>, goal: Goal, coverage: Vec<Coverage>) -> Self {
        Self {
            frames,
            goal,
            coverage,
            untouched_pictures: Vec::new(),
            untouched: None,
            forces: VecDeque::new(),
            tare: DVec3::ZERO,
            tared: 0,
            changes: Vec::new(),
            delay: None,
            presses: 0,
            is_free: true,
        }
    }

    /// How far it is.
    pub fn stage(&self) -> Stage {
        match (&self.untouched, self.delay) {
            (None, _) => Stage::Untouched {
                missing: UNTOUCHED_PICTURES.saturating_sub(self.untouched_pictures.len()),
            },
            (_, Some(delay)) if delay.correlation >= CORRELATED => Stage::Loads,
            (_, found) => Stage::Presses {
                missing: PRESSES.saturating_sub(self.presses),
                found,
            },
        }
    }

    /// What is known of each element.
    pub fn coverage(&self) -> &[Coverage] {
        &self.coverage
    }

    /// The goal.
    pub fn goal(&self) -> &Goal {
        &self.goal
    }

    /// Time that pictures come in after forces, once it is known.
    pub fn delay(&self) -> Option<Delay> {
        self.delay
    }

    /// Takes a force (N, fingertip's frame) that came in at a time, s.
    pub fn force(&mut self, at: f64, force: DVec3) {
        // Times do not go back, and what is not finite is no force.
        if !force.is_finite() || self.forces.back().is_some_and(|&(newest, _)| at < newest) {
            return;
        }
        let since = self.forces.back().map_or(0.0, |&(newest, _)| at - newest);
        if self.untouched.is_none() {
            self.tared += 1;
            self.tare += (force - self.tare) / f64::from(self.tared);
        } else if self.is_free && self.delay.is_some() {
            self.tare += (force - self.tare) * (since / TARE_TIME).min(1.0);
        }
        self.forces.push_back((at, force));
        while self
            .forces
            .front()
            .is_some_and(|&(oldest, _)| at - oldest > KEPT)
        {
            self.forces.pop_front();
        }
    }

    /// Takes the moments of a picture that came in at a time, s: what it was good for.
    pub fn picture(&mut self, at: f64, moments: &[ElementMoments]) -> Seen {
        let Some(untouched) = &self.untouched else {
            self.untouched_pictures.push(moments.to_vec());
            if self.untouched_pictures.len() >= UNTOUCHED_PICTURES && self.tared > 0 {
                self.untouched = Untouched::of(&self.untouched_pictures);
            }
            return Seen::Untouched;
        };
        let (contact, change) = untouched.contact(moments);
        let was_free = std::mem::replace(&mut self.is_free, contact == Contact::None);
        if self.stage() != Stage::Loads {
            self.changes.push((at, change));
            if self.is_free && !was_free {
                self.presses += 1;
                self.look_for_delay(at);
            }
            return Seen::Nothing;
        }
        match contact {
            Contact::None => Seen::Nothing,
            Contact::Unclear => Seen::Unclear,
            Contact::Element(element) => self.sample(at, element),
        }
    }

    fn sample(&mut self, at: f64, element: usize) -> Seen {
        let time = at - self.delay.map_or(0.0, |delay| delay.seconds);
        let half = 0.5 * CHANGE_TIME;
        let forces = [time - half, time, time + half].map(|time| self.force_at(time));
        let [Some(before), Some(force), Some(after)] = forces else {
            return Seen::Unclear;
        };
        if (after - before).length() > FASTEST * CHANGE_TIME * self.goal.normal {
            return Seen::Unclear;
        }
        let inward = self.frames[element].transpose() * (force - self.tare);
        // Compression is the force against the outward normal.
        let force = inward.with_z(-inward.z);
        match self.coverage[element].count(force, &self.goal) {
            true => Seen::Sample { element, force },
            false => Seen::Enough { element, force },
        }
    }

    /// The force at a time, if one is known on either side of it.
    fn force_at(&self, time: f64) -> Option<DVec3> {
        let after = self.forces.partition_point(|&(at, _)| at < time);
        let (from, start) = *self.forces.get(after.checked_sub(1)?)?;
        let (to, end) = *self.forces.get(after)?;
        let part = |axis: usize| between(&(from, start[axis]), &(to, end[axis]), time);
        Some(DVec3::new(part(0), part(1), part(2)))
    }

    fn look_for_delay(&mut self, at: f64) {
        if self.presses < PRESSES {
            return;
        }
        let oldest = self.forces.front().map_or(at, |&(oldest, _)| oldest);
        self.changes.retain(|&(at, _)| at >= oldest);
        let magnitude = |&(at, force): &(f64, DVec3)| (at, (force - self.tare).length());
        let forces: Vec<Timed> = self.forces.iter().map(magnitude).collect();
        // Noise alone may correlate by chance: it was pressed as hard as loads are.
        let pressed = forces
            .iter()
            .any(|&(_, force)| force > 0.2 * self.goal.normal);
        self.delay = delay::delay(&self.changes, &forces).filter(|_| pressed);
    }
}
