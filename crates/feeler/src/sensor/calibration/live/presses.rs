//! Guides the user through a few presses of a fingertip as a whole, to collect samples for
//! [`verify`](crate::sensor::wrench::verification::verify).

use super::synchronizer::{Of, Synchronizer};
use super::{Contact, Delay, Stage, Wrench};
use crate::sensor::moments::kernel::ElementMoments;

/// Minimum force of a press, as a fraction of full scale.
const PRESSED: f64 = 0.2;
/// Minimum time between samples, s; consecutive images show the same load.
const APART: f64 = 0.1;

/// Result of processing an image of a pressed fingertip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SeenPress {
    /// Image taken during the first stages, between presses, or too soon after the last sample. It yields no sample.
    Nothing,
    /// The load changes too fast or is unknown at the image's time.
    Unclear,
    /// A new sample was taken. The last one of a press is of the released fingertip.
    Sample(Wrench),
}

/// State of a series of live presses. Stages and times are the same as for [`LiveCalibration`](super::LiveCalibration);
/// the presses used to estimate the latency do not count.
#[derive(Debug)]
pub struct LivePresses {
    synchronizer: Synchronizer,
    full_scale: f64,
    wanted: u32,
    done: u32,
    is_pressed: bool,
    /// Time of the latest sample, s.
    sampled: f64,
}

impl LivePresses {
    /// Creates the state for `wanted` presses of about `full_scale` (N).
    pub fn new(full_scale: f64, wanted: u32) -> Self {
        Self {
            synchronizer: Synchronizer::new(full_scale),
            full_scale,
            wanted,
            done: 0,
            is_pressed: false,
            sampled: f64::NEG_INFINITY,
        }
    }

    /// Current stage.
    pub fn stage(&self) -> Stage {
        self.synchronizer.stage()
    }

    /// Number of presses still required.
    pub fn missing(&self) -> u32 {
        self.wanted.saturating_sub(self.done)
    }

    /// Latency of images relative to forces; `None` until it is estimated.
    pub fn delay(&self) -> Option<Delay> {
        self.synchronizer.delay()
    }

    /// Adds a wrench measured at time `at` (s); z of the fingertip frame points outward along its axis.
    pub fn wrench(&mut self, at: f64, wrench: Wrench) {
        self.synchronizer.load(at, wrench);
    }

    /// Returns whether the forces needed for an image taken at time `at` (s) have arrived.
    pub fn is_ready(&self, at: f64) -> bool {
        self.synchronizer.is_ready(at)
    }

    /// Adds the moments of an image taken at time `at` (s). A press of less than a fifth of full scale does not count.
    pub fn picture(&mut self, at: f64, moments: &[ElementMoments]) -> SeenPress {
        let Of::Loads(contact) = self.synchronizer.picture(at, moments) else {
            return SeenPress::Nothing;
        };
        let is_free = contact == Contact::None;
        if is_free && !self.is_pressed {
            return SeenPress::Nothing;
        }
        let Some(wrench) = self.synchronizer.load_of_picture(at) else {
            return SeenPress::Unclear;
        };
        let force = wrench.force.length();
        if is_free && force < PRESSED * self.full_scale {
            self.is_pressed = false;
            self.done += 1;
            return SeenPress::Sample(wrench);
        }
        self.is_pressed |= force >= PRESSED * self.full_scale;
        if at - self.sampled < APART {
            return SeenPress::Nothing;
        }
        self.sampled = at;
        SeenPress::Sample(wrench)
    }
}
