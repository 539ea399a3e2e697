//! Guides the user through loading a fingertip mounted on a six-axis force sensor, and turns incoming images and
//! forces into the samples for fitting a calibration ([`fit`](super::fit::fit)).
//!
//! 1. **Untouched**: measures forces and images without load.
//! 2. **Presses**: estimates the latency of images relative to forces from their correlation.
//! 3. **Loads**: collects samples. An image in which only one element is touched becomes a sample of that element, if
//!    more samples of this kind of load are required and the force changes slowly compared with the accuracy of the
//!    latency.
//!
//! If elements cannot be loaded individually, [`LiveWrench`] guides through loading the whole fingertip, in rounds.
//! [`LivePresses`] guides through a few presses that verify a calibration.
//!
//! Times are arrival times, or exposure times if the camera reports them, on one clock. Forces act on the fingertip and
//! are exerted by the object.

mod axes;
mod contact;
mod coverage;
mod delay;
mod presses;
mod synchronizer;
mod wrench;

pub use axes::{ForceAxes, ParseAxesError};
pub use coverage::{Coverage, Goal, Missing};
pub use delay::Delay;
pub use presses::{LivePresses, SeenPress};
pub use wrench::{LiveWrench, SeenWrench, Wrench, WrenchCoverage, WrenchMissing};

use crate::sensor::moments::kernel::ElementMoments;
use contact::Contact;
use glam::{DMat3, DVec3};
use synchronizer::{Of, Synchronizer};

/// Stage of a live calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stage {
    /// Images without load are collected.
    Untouched {
        /// Number of images still required.
        missing: usize,
    },
    /// Presses, each followed by a release, are recorded to determine the latency.
    Presses {
        /// Number of presses still required; 0 if all are done but images and forces do not correlate.
        missing: u32,
        /// Delay estimated so far, if any.
        found: Option<Delay>,
    },
    /// Elements are loaded.
    Loads,
}

/// Result of processing an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Seen {
    /// Image of the untouched fingertip. It contributes to the mean and noise of the unloaded elements.
    Untouched,
    /// Image taken during the presses or without contact. It yields no sample.
    Nothing,
    /// Several elements are touched, or the force changes too fast or is unknown at the image's time.
    Unclear,
    /// The force exceeds the goal, or enough samples of this kind of load are kept.
    Enough {
        /// Index of the touched element.
        element: usize,
        /// Force on the element, in its frame (N).
        force: DVec3,
    },
    /// A new sample was taken.
    Sample {
        /// Index of the touched element.
        element: usize,
        /// Force on it in its frame, N.
        force: DVec3,
    },
}

/// State of a live calibration.
#[derive(Debug)]
pub struct LiveCalibration {
    /// Rotation of each element's frame relative to the fingertip frame.
    frames: Vec<DMat3>,
    goal: Goal,
    coverage: Vec<Coverage>,
    synchronizer: Synchronizer,
}

impl LiveCalibration {
    /// Creates a calibration of a fingertip with elements rotated by `frames` relative to the fingertip's frame.
    /// `coverage` contains the samples already taken of each element.
    pub fn new(frames: Vec<DMat3>, goal: Goal, coverage: Vec<Coverage>) -> Self {
        Self {
            frames,
            goal,
            coverage,
            synchronizer: Synchronizer::new(goal.normal),
        }
    }

    /// Current stage.
    pub fn stage(&self) -> Stage {
        self.synchronizer.stage()
    }

    /// Samples taken so far, for each element.
    pub fn coverage(&self) -> &[Coverage] {
        &self.coverage
    }

    /// Full scale of the loads to collect.
    pub fn goal(&self) -> &Goal {
        &self.goal
    }

    /// Latency of images relative to forces; `None` until it is estimated.
    pub fn delay(&self) -> Option<Delay> {
        self.synchronizer.delay()
    }

    /// Adds a force (N, fingertip frame) measured at time `at` (s).
    pub fn force(&mut self, at: f64, force: DVec3) {
        let torque = DVec3::ZERO;
        self.synchronizer.load(at, Wrench { force, torque });
    }

    /// Returns whether the forces needed for an image taken at time `at` (s) have arrived. They may arrive later than
    /// the image if the camera is as fast as the force sensor.
    pub fn is_ready(&self, at: f64) -> bool {
        self.synchronizer.is_ready(at)
    }

    /// Adds the moments of an image taken at time `at` (s).
    pub fn picture(&mut self, at: f64, moments: &[ElementMoments]) -> Seen {
        match self.synchronizer.picture(at, moments) {
            Of::Untouched => Seen::Untouched,
            Of::Presses | Of::Loads(Contact::None) => Seen::Nothing,
            Of::Loads(Contact::Unclear) => Seen::Unclear,
            Of::Loads(Contact::Element(element)) => match self.synchronizer.load_of_picture(at) {
                None => Seen::Unclear,
                Some(load) => self.sample(element, load.force),
            },
        }
    }

    fn sample(&mut self, element: usize, force: DVec3) -> Seen {
        let inward = self.frames[element].transpose() * force;
        // Compression is the force against the outward normal.
        let force = inward.with_z(-inward.z);
        match self.coverage[element].count(force, &self.goal) {
            true => Seen::Sample { element, force },
            false => Seen::Enough { element, force },
        }
    }
}
