//! Guides through loading a fingertip that stands on a six-axis force sensor: from pictures and forces as they come in to the samples
//! that a calibration is fitted to ([`fit`](super::calibration_fit::fit)).
//!
//! 1. **Untouched**: what forces and pictures are without load.
//! 2. **Presses**: how much later than the force the picture of it comes in, by the correlation of both.
//! 3. **Loads**: each picture in which one element alone is touched is a sample of that element, if forces like it are still missing
//!    and the force does not change so fast that the delay's rest matters.
//!
//! Where no single element can be loaded, [`LiveWrench`] guides through loading the whole fingertip, in rounds.
//!
//! Times are of arrival, or of exposure where the camera says it, on one clock. Forces are those on the fingertip by what touches it.

mod axes;
mod contact;
mod coverage;
mod delay;
mod in_step;
mod wrench;

pub use axes::{AxesError, ForceAxes};
pub use coverage::{Coverage, Goal, Missing};
pub use delay::Delay;
pub use wrench::{LiveWrench, SeenWrench, Wrench, WrenchCoverage, WrenchMissing};

use super::moments::ElementMoments;
use contact::Contact;
use glam::{DMat3, DVec3};
use in_step::{InStep, Of};

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
    in_step: InStep,
}

impl LiveCalibration {
    /// Of a fingertip whose elements' frames are so in its own frame, with as much known of each as `coverage` says.
    pub fn new(frames: Vec<DMat3>, goal: Goal, coverage: Vec<Coverage>) -> Self {
        Self {
            frames,
            goal,
            coverage,
            in_step: InStep::new(goal.normal),
        }
    }

    /// How far it is.
    pub fn stage(&self) -> Stage {
        self.in_step.stage()
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
        self.in_step.delay()
    }

    /// Takes a force (N, fingertip's frame) that came in at a time, s.
    pub fn force(&mut self, at: f64, force: DVec3) {
        let torque = DVec3::ZERO;
        self.in_step.load(at, Wrench { force, torque });
    }

    /// Whether forces are known for as long as a picture that came in at a time (s) needs: a camera may be as fast as the force
    /// sensor.
    pub fn is_ready(&self, at: f64) -> bool {
        self.in_step.is_ready(at)
    }

    /// Takes the moments of a picture that came in at a time, s: what it was good for.
    pub fn picture(&mut self, at: f64, moments: &[ElementMoments]) -> Seen {
        match self.in_step.picture(at, moments) {
            Of::Untouched => Seen::Untouched,
            Of::Presses | Of::Loads(Contact::None) => Seen::Nothing,
            Of::Loads(Contact::Unclear) => Seen::Unclear,
            Of::Loads(Contact::Element(element)) => match self.in_step.load_of_picture(at) {
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
