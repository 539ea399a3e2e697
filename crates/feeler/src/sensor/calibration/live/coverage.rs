//! Samples collected for each element, and samples still missing.

use glam::DVec3;
use std::fmt;

/// Number of equal steps of compression from zero to full scale; each step must be sampled.
const STEPS: usize = 5;
/// Required number of samples of each kind of load.
const ENOUGH: u32 = 4;
/// Maximum number of samples of each kind of load; further ones are not kept.
const MOST: u32 = 8;
/// Minimum shear force along an axis, as a fraction of full scale.
const SHEARED: f64 = 0.3;
/// Directions of shear, in the element's frame.
const DIRECTIONS: [&str; 4] = ["+x", "-x", "+y", "-y"];

/// Numbers of samples of one element by kind of load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Coverage {
    compressed: [u32; STEPS],
    sheared: [u32; DIRECTIONS.len()],
}

/// Full scale of the loads to collect, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Maximum compression.
    pub normal: f64,
    /// Maximum shear force.
    pub shear: f64,
}

impl Coverage {
    /// Counts a sample with this force (N) in the element's frame. Returns `false` if enough samples of this kind of
    /// load have been kept, or if the force is out of range.
    pub fn count(&mut self, force: DVec3, goal: &Goal) -> bool {
        let step = (force.z / goal.normal * STEPS as f64).floor();
        if !(0.0..STEPS as f64).contains(&step) {
            return false;
        }
        let compressed = &mut self.compressed[step as usize];
        let shear = force.truncate() / goal.shear;
        let parts = [shear.x, -shear.x, shear.y, -shear.y];
        let sheared = (0..DIRECTIONS.len()).filter(|&k| parts[k] >= SHEARED);
        let mut wanted = *compressed < MOST;
        for direction in sheared.clone() {
            wanted |= self.sheared[direction] < MOST;
        }
        if wanted {
            *compressed += 1;
            sheared.for_each(|direction| self.sheared[direction] += 1);
        }
        wanted
    }

    /// Returns whether no samples are missing.
    pub fn is_complete(&self) -> bool {
        self.part() >= 1.0
    }

    /// Fraction of the required samples that are present, 0 to 1.
    pub fn part(&self) -> f64 {
        let counts = self.compressed.iter().chain(&self.sheared);
        let there: u32 = counts.clone().map(|&count| count.min(ENOUGH)).sum();
        f64::from(there) / f64::from(ENOUGH * counts.count() as u32)
    }

    /// Describes the missing samples.
    pub fn missing(&self, goal: &Goal) -> Missing {
        Missing {
            coverage: *self,
            goal: *goal,
        }
    }
}

/// Displays the missing samples of an element.
#[derive(Debug, Clone, Copy)]
pub struct Missing {
    coverage: Coverage,
    goal: Goal,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { coverage, goal } = self;
        let width = goal.normal / STEPS as f64;
        let mut separator = "";
        // Consecutive steps form one range.
        let mut first = 0;
        for range in coverage
            .compressed
            .chunk_by(|a, b| (*a < ENOUGH) == (*b < ENOUGH))
        {
            let (from, to) = (first as f64 * width, (first + range.len()) as f64 * width);
            if range[0] < ENOUGH {
                write!(f, "{separator}press with {from:.2} to {to:.2} N")?;
                separator = ", ";
            }
            first += range.len();
        }
        let few = |&(_, count): &(&str, u32)| count < ENOUGH;
        let directions = DIRECTIONS.into_iter().zip(coverage.sheared).filter(few);
        let names: Vec<&str> = directions.map(|(name, _)| name).collect();
        if !names.is_empty() {
            let least = SHEARED * goal.shear;
            write!(
                f,
                "{separator}push towards {} with over {least:.2} N",
                names.join(", ")
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOAL: Goal = Goal {
        normal: 1.0,
        shear: 0.5,
    };

    #[test]
    fn coverage_is_complete_after_all_compressions_and_directions() {
        let mut coverage = Coverage::default();
        assert!(
            !coverage.count(DVec3::new(0.0, 0.0, 1.0), &GOAL),
            "beyond the goal"
        );
        assert!(!coverage.count(DVec3::new(0.0, 0.0, -0.1), &GOAL), "pulled");
        for step in 0..5 {
            for kept in 0..9 {
                let force = DVec3::new(0.0, 0.0, 0.1 + 0.2 * f64::from(step));
                assert_eq!(coverage.count(force, &GOAL), kept < 8);
            }
        }
        let words = coverage.missing(&GOAL).to_string();
        assert_eq!(words, "push towards +x, -x, +y, -y with over 0.15 N");
        assert!((coverage.part() - 5.0 / 9.0).abs() < 1e-12);
        for (x, y) in [(0.2, 0.2), (-0.2, -0.2)] {
            for _ in 0..4 {
                assert!(!coverage.is_complete());
                assert!(coverage.count(DVec3::new(x, y, 0.5), &GOAL));
            }
        }
        assert!(coverage.is_complete() && coverage.missing(&GOAL).to_string().is_empty());
        assert!(
            Coverage::default()
                .missing(&GOAL)
                .to_string()
                .starts_with("press with 0.00 to 1.00 N, push")
        );
    }
}
