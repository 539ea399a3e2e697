//! Pictures and loads in step: the tare of the force sensor, the untouched fingertip, and how late pictures are.

use super::contact::{Contact, Untouched};
use super::delay::{Delay, Timed, between, delay};
use super::{Stage, Wrench};
use crate::sensor::moments::ElementMoments;
use glam::DVec3;
use std::collections::VecDeque;

/// Pictures without load that the untouched fingertip is known by.
const UNTOUCHED_PICTURES: usize = 16;
/// Loads are kept for so long, s.
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

/// What a picture is of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Of {
    /// The untouched fingertip, while that is looked at.
    Untouched,
    /// Presses for the delay.
    Presses,
    /// What is touched, once loads are taken.
    Loads(Contact),
}

/// The state that pictures and loads share.
#[derive(Debug)]
pub(super) struct InStep {
    /// Force that loads go up to, N.
    full_scale: f64,
    untouched_pictures: Vec<Vec<ElementMoments>>,
    untouched: Option<Untouched>,
    /// Time and load on the fingertip, in its frame, with the tare in it.
    loads: VecDeque<(f64, Wrench)>,
    /// Mean of the loads while nothing is touched, and the number of them.
    tare: Wrench,
    tared: u32,
    /// How much pictures changed, while the delay is looked for.
    changes: Vec<Timed>,
    delay: Option<Delay>,
    /// Presses that have ended.
    presses: u32,
    /// Whether the newest picture showed nothing touched.
    is_free: bool,
}

impl InStep {
    /// Of loads up to `full_scale`, N.
    pub(super) fn new(full_scale: f64) -> Self {
        Self {
            full_scale,
            untouched_pictures: Vec::new(),
            untouched: None,
            loads: VecDeque::new(),
            tare: Wrench::default(),
            tared: 0,
            changes: Vec::new(),
            delay: None,
            presses: 0,
            is_free: true,
        }
    }

    /// How far it is.
    pub(super) fn stage(&self) -> Stage {
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

    /// Time that pictures come in after forces, once it is known.
    pub(super) fn delay(&self) -> Option<Delay> {
        self.delay
    }

    /// Takes a load (fingertip's frame) that came in at a time, s.
    pub(super) fn load(&mut self, at: f64, load: Wrench) {
        // Times do not go back, and what is not finite is no load.
        let newest = self.loads.back().map(|&(newest, _)| newest);
        if !load.is_finite() || newest.is_some_and(|newest| at < newest) {
            return;
        }
        let since = newest.map_or(0.0, |newest| at - newest);
        if self.untouched.is_none() {
            self.tared += 1;
            self.tare = self.tare.towards(load, 1.0 / f64::from(self.tared));
        } else if self.is_free && self.delay.is_some() {
            self.tare = self.tare.towards(load, (since / TARE_TIME).min(1.0));
        }
        self.loads.push_back((at, load));
        while self
            .loads
            .front()
            .is_some_and(|&(oldest, _)| at - oldest > KEPT)
        {
            self.loads.pop_front();
        }
    }

    /// Takes the moments of a picture that came in at a time, s: what it is of.
    pub(super) fn picture(&mut self, at: f64, moments: &[ElementMoments]) -> Of {
        let Some(untouched) = &self.untouched else {
            self.untouched_pictures.push(moments.to_vec());
            if self.untouched_pictures.len() >= UNTOUCHED_PICTURES && self.tared > 0 {
                self.untouched = Untouched::of(&self.untouched_pictures);
            }
            return Of::Untouched;
        };
        let (contact, change) = untouched.contact(moments);
        let was_free = std::mem::replace(&mut self.is_free, contact == Contact::None);
        if self.stage() == Stage::Loads {
            return Of::Loads(contact);
        }
        self.changes.push((at, change));
        if self.is_free && !was_free {
            self.presses += 1;
            self.look_for_delay(at);
        }
        Of::Presses
    }

    /// Whether loads are known for as long as a picture that came in at a time (s) needs.
    pub(super) fn is_ready(&self, at: f64) -> bool {
        let needed = self.time_of_picture(at) + 0.5 * CHANGE_TIME;
        let newest = self.loads.back().map(|&(newest, _)| newest);
        self.stage() != Stage::Loads || newest.is_some_and(|newest| newest >= needed)
    }

    /// When the load was that a picture which came in at a time shows, s.
    fn time_of_picture(&self, at: f64) -> f64 {
        at - self.delay.map_or(0.0, |delay| delay.seconds)
    }

    /// The load, without the tare, that a picture which came in at a time (s) shows; none where it is not known, or changes so fast
    /// that the rest of the delay matters.
    pub(super) fn load_of_picture(&self, at: f64) -> Option<Wrench> {
        let time = self.time_of_picture(at);
        let half = 0.5 * CHANGE_TIME;
        let before = self.load_at(time - half)?.force;
        let load = self.load_at(time)?;
        let after = self.load_at(time + half)?.force;
        let is_slow = (after - before).length() <= FASTEST * CHANGE_TIME * self.full_scale;
        is_slow.then(|| load.without(self.tare))
    }

    /// The load at a time, if one is known on either side of it.
    fn load_at(&self, time: f64) -> Option<Wrench> {
        let after = self.loads.partition_point(|&(at, _)| at < time);
        let (from, start) = *self.loads.get(after.checked_sub(1)?)?;
        let (to, end) = *self.loads.get(after)?;
        let part = |of: fn(&Wrench) -> DVec3, axis: usize| {
            between(&(from, of(&start)[axis]), &(to, of(&end)[axis]), time)
        };
        let all = |of| DVec3::new(part(of, 0), part(of, 1), part(of, 2));
        Some(Wrench {
            force: all(|load| load.force),
            torque: all(|load| load.torque),
        })
    }

    fn look_for_delay(&mut self, at: f64) {
        if self.presses < PRESSES {
            return;
        }
        let oldest = self.loads.front().map_or(at, |&(oldest, _)| oldest);
        self.changes.retain(|&(at, _)| at >= oldest);
        let magnitude = |&(at, load): &(f64, Wrench)| (at, load.without(self.tare).force.length());
        let forces: Vec<Timed> = self.loads.iter().map(magnitude).collect();
        // Noise alone may correlate by chance: it was pressed as hard as loads are.
        let pressed = forces
            .iter()
            .any(|&(_, force)| force > 0.2 * self.full_scale);
        self.delay = delay(&self.changes, &forces).filter(|_| pressed);
    }
}
