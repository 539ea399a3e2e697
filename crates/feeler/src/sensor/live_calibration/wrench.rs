//! Guides through loading a fingertip as a whole, where no single element can be loaded: to what
//! [`wrench::fit`](crate::sensor::wrench::fit) is fitted to.

use super::in_step::{InStep, Of};
use super::{Contact, Delay, Goal, Stage};
use crate::sensor::moments::ElementMoments;
use glam::DVec3;
use std::fmt;

/// Parts of the compression up to full scale that must be known.
const STEPS: usize = 5;
/// Directions of shear, in the fingertip's frame, and parts of full scale that must be known along each.
const DIRECTIONS: [&str; 4] = ["+x", "-x", "+y", "-y"];
const SHEARED: [f64; 2] = [0.3, 0.65];
/// All of that is gone through so often, and each time so many samples of each kind are kept: the error is found with a fifth of the
/// time left out, and should find no kind of load there that the rest does not know.
const ROUNDS: u32 = 5;
const PER_ROUND: u32 = 4;
/// Least time between samples, s: one picture after the other shows the same load.
const APART: f64 = 0.1;

/// Force (N) and torque (N m) on the fingertip by what touches it, in its frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// The force, N.
    pub force: DVec3,
    /// The torque about the force sensor's origin, N m.
    pub torque: DVec3,
}

impl Wrench {
    /// Whether all of it is a number.
    pub(super) fn is_finite(&self) -> bool {
        self.force.is_finite() && self.torque.is_finite()
    }

    /// This, moved by a part of the way towards another.
    pub(super) fn towards(self, other: Self, part: f64) -> Self {
        Self {
            force: self.force + part * (other.force - self.force),
            torque: self.torque + part * (other.torque - self.torque),
        }
    }

    /// This less another.
    pub(super) fn without(self, other: Self) -> Self {
        Self {
            force: self.force - other.force,
            torque: self.torque - other.torque,
        }
    }
}

/// Samples of the whole fingertip, by kind.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WrenchCoverage {
    compressed: [u32; STEPS],
    sheared: [[u32; SHEARED.len()]; DIRECTIONS.len()],
}

impl WrenchCoverage {
    /// Counts a force on the fingertip, N, z outward along its axis, so that pressing makes it negative; false where as many of its
    /// kind are there as this round needs.
    pub fn count(&mut self, force: DVec3, goal: &Goal) -> bool {
        let step = (-force.z / goal.normal * STEPS as f64).floor();
        if !(0.0..STEPS as f64).contains(&step) {
            return false;
        }
        let enough = (self.round() + 1) * PER_ROUND;
        let shear = force.truncate() / goal.shear;
        let parts = [shear.x, -shear.x, shear.y, -shear.y];
        let compressed = &mut self.compressed[step as usize];
        let sheared = self.sheared.iter_mut().zip(parts);
        let mut kinds: Vec<&mut u32> = vec![compressed];
        kinds.extend(sheared.filter_map(|(counts, part)| {
            let level = SHEARED.iter().rposition(|&least| part >= least)?;
            Some(&mut counts[level])
        }));
        let wanted = kinds.iter().any(|count| **count < enough);
        if wanted {
            kinds.into_iter().for_each(|count| *count += 1);
        }
        wanted
    }

    fn counts(&self) -> impl Iterator<Item = u32> {
        let sheared = self.sheared.iter().flatten();
        self.compressed.iter().chain(sheared).copied()
    }

    /// How often all of it was gone through.
    pub fn round(&self) -> u32 {
        self.counts().min().unwrap_or(0) / PER_ROUND
    }

    /// How often all of it is to be gone through.
    pub const fn rounds() -> u32 {
        ROUNDS
    }

    /// Whether nothing is missing.
    pub fn is_complete(&self) -> bool {
        self.round() >= ROUNDS
    }

    /// How much is there of what must be, 0 to 1.
    pub fn part(&self) -> f64 {
        let most = ROUNDS * PER_ROUND;
        let there: u32 = self.counts().map(|count| count.min(most)).sum();
        f64::from(there) / f64::from(most * self.counts().count() as u32)
    }

    /// What is missing in this round, in words.
    pub fn missing(&self, goal: &Goal) -> WrenchMissing {
        WrenchMissing {
            coverage: self.clone(),
            goal: *goal,
        }
    }
}

/// What is missing of a fingertip in this round, in words.
#[derive(Debug, Clone)]
pub struct WrenchMissing {
    coverage: WrenchCoverage,
    goal: Goal,
}

impl fmt::Display for WrenchMissing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { coverage, goal } = self;
        let enough = (coverage.round() + 1) * PER_ROUND;
        let mut separator = "";
        let width = goal.normal / STEPS as f64;
        for (step, _) in (coverage.compressed.iter().enumerate()).filter(|(_, n)| **n < enough) {
            let (from, to) = (step as f64 * width, (step + 1) as f64 * width);
            write!(f, "{separator}press with {from:.2} to {to:.2} N")?;
            separator = ", ";
        }
        for (level, part) in SHEARED.iter().enumerate() {
            let directions = DIRECTIONS.iter().zip(&coverage.sheared);
            let names: Vec<&str> = directions
                .filter(|(_, counts)| counts[level] < enough)
                .map(|(name, _)| *name)
                .collect();
            if !names.is_empty() {
                let (least, names) = (part * goal.shear, names.join(", "));
                write!(f, "{separator}push towards {names} with ")?;
                match SHEARED.get(level + 1) {
                    Some(next) => write!(f, "{least:.2} to {:.2} N", next * goal.shear)?,
                    None => write!(f, "over {least:.2} N")?,
                }
                separator = ", ";
            }
        }
        Ok(())
    }
}

/// What a picture of the whole fingertip was good for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SeenWrench {
    /// It is one of the untouched fingertip.
    Untouched,
    /// One of the presses, or while nothing is touched.
    Nothing,
    /// The load is gone too fast or not known at its time.
    Unclear,
    /// More than the goal, pulled, or as many like it are there as are kept in this round.
    Enough(Wrench),
    /// A sample to keep.
    Sample(Wrench),
}

/// The state of a live calibration of the whole fingertip. Stages and times are those of
/// [`LiveCalibration`](super::LiveCalibration).
#[derive(Debug)]
pub struct LiveWrench {
    in_step: InStep,
    goal: Goal,
    coverage: WrenchCoverage,
    /// When the newest sample was taken, s.
    sampled: f64,
}

impl LiveWrench {
    /// With as much known as `coverage` says.
    pub fn new(goal: Goal, coverage: WrenchCoverage) -> Self {
        Self {
            in_step: InStep::new(goal.normal),
            goal,
            coverage,
            sampled: f64::NEG_INFINITY,
        }
    }

    /// How far it is.
    pub fn stage(&self) -> Stage {
        self.in_step.stage()
    }

    /// What is known.
    pub fn coverage(&self) -> &WrenchCoverage {
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

    /// Takes a wrench that came in at a time, s; z of the fingertip's frame is outward along its axis.
    pub fn wrench(&mut self, at: f64, wrench: Wrench) {
        self.in_step.load(at, wrench);
    }

    /// Whether forces are known for as long as a picture that came in at a time (s) needs: a camera may be as fast as the force
    /// sensor.
    pub fn is_ready(&self, at: f64) -> bool {
        self.in_step.is_ready(at)
    }

    /// Takes the moments of a picture that came in at a time, s: what it was good for.
    pub fn picture(&mut self, at: f64, moments: &[ElementMoments]) -> SeenWrench {
        match self.in_step.picture(at, moments) {
            Of::Untouched => SeenWrench::Untouched,
            Of::Presses | Of::Loads(Contact::None) => SeenWrench::Nothing,
            Of::Loads(_) => match self.in_step.load_of_picture(at) {
                None => SeenWrench::Unclear,
                Some(wrench) => self.sample(at, wrench),
            },
        }
    }

    fn sample(&mut self, at: f64, wrench: Wrench) -> SeenWrench {
        if at - self.sampled < APART || !self.coverage.count(wrench.force, &self.goal) {
            return SeenWrench::Enough(wrench);
        }
        self.sampled = at;
        SeenWrench::Sample(wrench)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOAL: Goal = Goal {
        normal: 1.0,
        shear: 0.5,
    };

    /// Compressions in all steps, and half-way down shear of both sizes in all directions, four of each: a round.
    fn round() -> Vec<DVec3> {
        let mut forces = Vec::new();
        for _ in 0..PER_ROUND {
            forces.extend((0..STEPS).map(|step| DVec3::new(0.0, 0.0, -0.1 - 0.2 * step as f64)));
            for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
                forces.extend([0.2, 0.4].map(|shear| DVec3::new(shear * x, shear * y, -0.5)));
            }
        }
        forces
    }

    #[test]
    fn a_fingertip_is_complete_when_it_was_loaded_all_ways_in_each_of_five_rounds() {
        let mut coverage = WrenchCoverage::default();
        assert!(!coverage.count(DVec3::new(0.0, 0.0, 0.1), &GOAL), "pulled");
        assert!(!coverage.count(DVec3::new(0.0, 0.0, -1.0), &GOAL), "beyond");
        for number in 0..ROUNDS {
            assert_eq!(coverage.round(), number);
            assert!((coverage.part() - f64::from(number) / f64::from(ROUNDS)).abs() < 0.1);
            // One kind alone is not taken over and over.
            let press = DVec3::new(0.0, 0.0, -0.9);
            let taken = (0..100).filter(|_| coverage.count(press, &GOAL)).count();
            assert_eq!(taken, PER_ROUND as usize);
            for force in round() {
                coverage.count(force, &GOAL);
            }
        }
        assert!(coverage.is_complete());
    }

    #[test]
    fn what_is_missing_is_said_in_words() {
        let mut coverage = WrenchCoverage::default();
        let words = coverage.missing(&GOAL).to_string();
        assert!(
            words.starts_with("press with 0.00 to 0.20 N, press"),
            "{words}"
        );
        for force in round().into_iter().filter(|force| force.x >= 0.0) {
            coverage.count(force, &GOAL);
        }
        assert_eq!(
            coverage.missing(&GOAL).to_string(),
            "push towards -x with 0.15 to 0.33 N, push towards -x with over 0.33 N"
        );
    }
}
