//! Synchronizes images and loads: tare of the force sensor, statistics of the untouched fingertip, and latency of the
//! images.

use super::contact::{Contact, Untouched};
use super::delay::{Delay, Timed, between, delay};
use super::{Stage, Wrench};
use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec3;
use std::collections::VecDeque;

/// Number of unloaded images for the statistics of the untouched fingertip.
const UNTOUCHED_PICTURES: usize = 16;
/// Duration for which measured loads are stored, s.
const KEPT: f64 = 20.0;
/// Minimum correlation of images and forces for a delay to be accepted.
const CORRELATED: f64 = 0.9;
/// Minimum number of complete presses for estimating the delay. The response of images is nonlinear in the force; if
/// only one flank of a press were recorded, this would look like a delay.
const PRESSES: u32 = 3;
/// Maximum rate of change of the force during a sample, in full scales per second.
const FASTEST: f64 = 2.0;
/// Time over which that rate of change is measured, s.
const CHANGE_TIME: f64 = 0.02;
/// Time constant with which the tare follows the reading of the unloaded force sensor, s.
const TARE_TIME: f64 = 2.0;

/// Stage that uses an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Of {
    /// Statistics of the untouched fingertip, in the first stage.
    Untouched,
    /// Estimation of the delay, from presses.
    Presses,
    /// Collection of loads, with the contact in the image.
    Loads(Contact),
}

/// Tare, delay and contact state shared by images and loads.
#[derive(Debug)]
pub(super) struct Synchronizer {
    /// Full-scale force of the loads to collect, N.
    full_scale: f64,
    untouched_pictures: Vec<Vec<ElementMoments>>,
    untouched: Option<Untouched>,
    /// Time (s) and measured load on the fingertip, in its frame, before the tare is subtracted.
    loads: VecDeque<(f64, Wrench)>,
    /// Mean load measured while nothing touches the fingertip.
    tare: Wrench,
    /// Number of loads averaged in the initial tare.
    tared: u32,
    /// Time and deviation of each image from the unloaded ones, while the delay is estimated.
    changes: Vec<Timed>,
    delay: Option<Delay>,
    /// Number of completed presses.
    presses: u32,
    /// `true` if nothing was touched in the latest image.
    is_free: bool,
}

impl Synchronizer {
    /// Creates the state for loads up to `full_scale` (N).
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

    /// Current stage.
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

    /// Latency of images relative to forces; `None` until it is estimated.
    pub(super) fn delay(&self) -> Option<Delay> {
        self.delay
    }

    /// Adds a load (fingertip frame) measured at time `at` (s).
    pub(super) fn load(&mut self, at: f64, load: Wrench) {
        // Ignores loads that are not finite or out of order.
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

    /// Adds the moments of an image taken at time `at` (s). Returns the stage that uses the image.
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

    /// Returns whether the loads needed for an image taken at time `at` (s) have arrived.
    pub(super) fn is_ready(&self, at: f64) -> bool {
        let needed = self.time_of_picture(at) + 0.5 * CHANGE_TIME;
        let newest = self.loads.back().map(|&(newest, _)| newest);
        self.stage() != Stage::Loads || newest.is_some_and(|newest| newest >= needed)
    }

    /// Time (s) of the load measurements that correspond to an image with the time stamp `at` (s): earlier by the
    /// latency.
    fn time_of_picture(&self, at: f64) -> f64 {
        at - self.delay.map_or(0.0, |delay| delay.seconds)
    }

    /// Load during the exposure of an image with the time stamp `at` (s), with the tare subtracted. `None` if it is
    /// unknown or changes too fast for the accuracy of the delay.
    pub(super) fn load_of_picture(&self, at: f64) -> Option<Wrench> {
        let time = self.time_of_picture(at);
        let half = 0.5 * CHANGE_TIME;
        let before = self.load_at(time - half)?.force;
        let load = self.load_at(time)?;
        let after = self.load_at(time + half)?.force;
        let is_slow = (after - before).length() <= FASTEST * CHANGE_TIME * self.full_scale;
        is_slow.then(|| load.without(self.tare))
    }

    /// Load interpolated at `time`; `None` unless loads before and after it are known.
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
        // Noise alone may correlate by chance, so a minimum force is required.
        let pressed = forces
            .iter()
            .any(|&(_, force)| force > 0.2 * self.full_scale);
        self.delay = delay(&self.changes, &forces).filter(|_| pressed);
    }
}
