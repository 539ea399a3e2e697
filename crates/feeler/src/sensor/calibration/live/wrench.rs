//! Guides the user through loading a fingertip as a whole, if elements cannot be loaded individually, to collect
//! samples for [`wrench::fit`](crate::sensor::wrench::fit).

use super::synchronizer::{Of, Synchronizer};
use super::{Contact, Delay, Goal, Stage};
use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec3;
use std::fmt;

/// Number of equal steps of compression from zero to full scale; each step must be sampled.
const STEPS: usize = 5;
/// Directions of shear in the fingertip frame.
const DIRECTIONS: [&str; 4] = ["+x", "-x", "+y", "-y"];
/// Minimum forces of the two levels of shear in each direction, as fractions of full scale.
const SHEARED: [f64; 2] = [0.3, 0.65];
/// Number of rounds. Cross-validation holds out a fifth of the time; the remaining rounds must cover all kinds of
/// loads.
const ROUNDS: u32 = 5;
/// Number of samples of each kind of load per round.
const PER_ROUND: u32 = 4;
/// Minimum time between samples, s; consecutive images show the same load.
const APART: f64 = 0.1;

/// Force (N) and torque (N·m) on the fingertip by the object, in the fingertip frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// Force, N.
    pub force: DVec3,
    /// Torque about the force sensor's origin, N·m.
    pub torque: DVec3,
}

impl Wrench {
    /// Returns whether all components are finite.
    pub(super) fn is_finite(&self) -> bool {
        self.force.is_finite() && self.torque.is_finite()
    }

    /// Interpolates linearly towards `other` by the fraction `part`.
    pub(super) fn towards(self, other: Self, part: f64) -> Self {
        Self {
            force: self.force + part * (other.force - self.force),
            torque: self.torque + part * (other.torque - self.torque),
        }
    }

    /// Subtracts `other`.
    pub(super) fn without(self, other: Self) -> Self {
        Self {
            force: self.force - other.force,
            torque: self.torque - other.torque,
        }
    }
}

/// Numbers of samples of the whole fingertip by kind of load.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WrenchCoverage {
    compressed: [u32; STEPS],
    sheared: [[u32; SHEARED.len()]; DIRECTIONS.len()],
}

impl WrenchCoverage {
    /// Counts a sample with this force (N) on the fingertip, with z outward along its axis, so that pressing is
    /// negative. Returns `false` if this round needs no more samples of this kind of load, or if the force is out of
    /// range.
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

    /// Number of completed rounds.
    pub fn round(&self) -> u32 {
        self.counts().min().unwrap_or(0) / PER_ROUND
    }

    /// Number of required rounds.
    pub const fn rounds() -> u32 {
        ROUNDS
    }

    /// Returns whether no samples are missing.
    pub fn is_complete(&self) -> bool {
        self.round() >= ROUNDS
    }

    /// Fraction of the required samples that are present, 0 to 1.
    pub fn part(&self) -> f64 {
        let most = ROUNDS * PER_ROUND;
        let there: u32 = self.counts().map(|count| count.min(most)).sum();
        f64::from(there) / f64::from(most * self.counts().count() as u32)
    }

    /// Describes the samples missing in this round.
    pub fn missing(&self, goal: &Goal) -> WrenchMissing {
        WrenchMissing {
            coverage: self.clone(),
            goal: *goal,
        }
    }
}

/// Displays the samples of a fingertip missing in this round.
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

/// Result of processing an image of the whole fingertip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SeenWrench {
    /// Image of the untouched fingertip. It contributes to the mean and noise of the unloaded elements.
    Untouched,
    /// Image taken during the presses or without contact. It yields no sample.
    Nothing,
    /// The load changes too fast or is unknown at the image's time.
    Unclear,
    /// The load exceeds the goal or is tensile, or this round needs no more samples of this kind of load.
    Enough(Wrench),
    /// A new sample was taken.
    Sample(Wrench),
}

/// State of a live calibration of the whole fingertip. Stages and times are the same as for
/// [`LiveCalibration`](super::LiveCalibration).
#[derive(Debug)]
pub struct LiveWrench {
    synchronizer: Synchronizer,
    goal: Goal,
    coverage: WrenchCoverage,
    /// Time of the latest sample, s.
    sampled: f64,
}

impl LiveWrench {
    /// Creates a calibration. `coverage` contains the samples already taken.
    pub fn new(goal: Goal, coverage: WrenchCoverage) -> Self {
        Self {
            synchronizer: Synchronizer::new(goal.normal),
            goal,
            coverage,
            sampled: f64::NEG_INFINITY,
        }
    }

    /// Current stage.
    pub fn stage(&self) -> Stage {
        self.synchronizer.stage()
    }

    /// Samples taken so far.
    pub fn coverage(&self) -> &WrenchCoverage {
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

    /// Adds a wrench measured at time `at` (s); z of the fingertip frame points outward along its axis.
    pub fn wrench(&mut self, at: f64, wrench: Wrench) {
        self.synchronizer.load(at, wrench);
    }

    /// Returns whether the forces needed for an image taken at time `at` (s) have arrived. They may arrive later than
    /// the image if the camera is as fast as the force sensor.
    pub fn is_ready(&self, at: f64) -> bool {
        self.synchronizer.is_ready(at)
    }

    /// Adds the moments of an image taken at time `at` (s).
    pub fn picture(&mut self, at: f64, moments: &[ElementMoments]) -> SeenWrench {
        match self.synchronizer.picture(at, moments) {
            Of::Untouched => SeenWrench::Untouched,
            Of::Presses | Of::Loads(Contact::None) => SeenWrench::Nothing,
            Of::Loads(_) => match self.synchronizer.load_of_picture(at) {
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

    /// One round: four samples each of compression in all steps, and of shear at both levels in all directions at
    /// half compression.
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
    fn coverage_is_complete_after_five_rounds_of_all_loads() {
        let mut coverage = WrenchCoverage::default();
        assert!(!coverage.count(DVec3::new(0.0, 0.0, 0.1), &GOAL), "pulled");
        assert!(!coverage.count(DVec3::new(0.0, 0.0, -1.0), &GOAL), "beyond");
        for number in 0..ROUNDS {
            assert_eq!(coverage.round(), number);
            assert!((coverage.part() - f64::from(number) / f64::from(ROUNDS)).abs() < 0.1);
            // One kind of load alone is limited per round.
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
    fn missing_samples_are_described() {
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
