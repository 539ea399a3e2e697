//! The pattern of the strokes in the paper's Fig. 8, as far as its text tells it.
//!
//! "Compared to the 1st screwing motion, both grasping force and torque decrease considerably in the 2nd screwing, and in
//! the 3rd and 4th screwings they increase compared to the former two screwings. […] the 3rd and 4th screwings show
//! almost the same variations in grasping force and torque" (section VI.A). Nothing claims that a run shows it: it is told,
//! so that it can be counted.
//!
//! What is compared is what a reader of the figure compares, its peaks ("four heaps are found in Fig. 8"): of torque the
//! *peak* of each stroke, which rises within the first one; of grasp force the
//! *mean over MOVE*, as the same text calls it constant in the first stroke while torque rises, and as its peak there would
//! be the 1 N at which every stroke begins to move. *Decrease* and *increase* are taken at their weakest: any amount.

use super::strokes::StrokeMeasures;
use serde::Serialize;

/// Largest relative change from stroke 3 to stroke 4 at which both are alike, as the claim `closed-after-third` has it.
pub const ALIKE: f64 = 0.15;

/// How four peaks stand to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Peaks {
    /// The second is below the first.
    pub second_below_first: bool,
    /// The third and the fourth are above the first and the second.
    pub last_above_first: bool,
    /// The third and the fourth are [`ALIKE`].
    pub last_alike: bool,
}

impl Peaks {
    /// Compares the heights of four peaks.
    pub fn new([first, second, third, fourth]: [f64; 4]) -> Self {
        Self {
            second_below_first: second < first,
            last_above_first: third.min(fourth) > first.max(second),
            last_alike: third > 0.0 && ((fourth - third) / third).abs() <= ALIKE,
        }
    }

    /// Whether all is as the text says.
    pub fn whole(&self) -> bool {
        self.second_below_first && self.last_above_first && self.last_alike
    }
}

/// The pattern of a run's strokes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct StrokePattern {
    /// Of grasp force, mean over MOVE.
    pub grasp_force: Peaks,
    /// Of torque, peak of the stroke.
    pub torque: Peaks,
}

impl StrokePattern {
    /// The pattern of strokes 1 to 4; none unless all are measured.
    pub fn new(strokes: &[StrokeMeasures]) -> Option<Self> {
        let heights = |measure: fn(&StrokeMeasures) -> Option<f64>| {
            let height = |index| measure(strokes.iter().find(|s| s.index == index)?);
            Some([height(1)?, height(2)?, height(3)?, height(4)?])
        };
        Some(Self {
            grasp_force: Peaks::new(heights(|m| m.mean_grasp_force)?),
            torque: Peaks::new(heights(|m| m.peak_torque)?),
        })
    }

    /// Whether stroke 2 is below stroke 1 in both.
    pub fn second_below_first(&self) -> bool {
        self.grasp_force.second_below_first && self.torque.second_below_first
    }

    /// Whether all is as the text says, of both.
    pub fn whole(&self) -> bool {
        self.grasp_force.whole() && self.torque.whole()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_compared_part_by_part() {
        let parts = |heights| {
            let peaks = Peaks::new(heights);
            let Peaks {
                second_below_first,
                last_above_first,
                last_alike,
            } = peaks;
            let whole = peaks.whole();
            [second_below_first, last_above_first, last_alike, whole]
        };
        for (heights, expected) in [
            // As in the paper's text.
            ([1.0, 0.6, 1.4, 1.5], [true, true, true, true]),
            // The cap tightens from stroke to stroke.
            ([1.0, 1.2, 1.4, 1.5], [false, true, true, false]),
            // Below the first, but so is the third.
            ([1.0, 0.6, 0.9, 1.0], [true, false, true, false]),
            // The fourth is what is not above the first.
            ([1.0, 0.6, 1.1, 1.0], [true, false, true, false]),
            // The fourth goes on rising, or falls.
            ([1.0, 0.6, 1.4, 1.7], [true, true, false, false]),
            ([1.0, 0.6, 1.7, 1.4], [true, true, false, false]),
            // As high is not above, and not below.
            ([1.0, 1.0, 1.0, 1.0], [false, false, true, false]),
            // A torque that is none.
            ([0.0, -1.0, 0.0, 0.0], [true, false, false, false]),
        ] {
            assert_eq!(parts(heights), expected, "{heights:?}");
        }
        let at_the_bound = Peaks::new([1.0, 0.5, 2.0, 2.0 * (1.0 + ALIKE)]);
        assert!(at_the_bound.last_alike);
    }
}
