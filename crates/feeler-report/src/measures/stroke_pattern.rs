//! Comparison of the strokes with the paper's Fig. 8, as described in its text.
//!
//! "Compared to the 1st screwing motion, both grasping force and torque decrease considerably in the 2nd screwing, and
//! in the 3rd and 4th screwings they increase compared to the former two screwings. […] the 3rd and 4th screwings show
//! almost the same variations in grasping force and torque" (section VI.A). No claim depends on this pattern; it is
//! reported for statistics.
//!
//! The comparison uses what a reader sees in the figure ("four heaps are found in Fig. 8"). For torque this is the
//! *peak* of each stroke, because torque rises within the first stroke. For grasp force it is the *mean over MOVE*,
//! because the text calls grasp force constant in the first stroke while torque rises, and its peak would be the 1 N at
//! which every stroke starts to move. *Decrease* and *increase* mean any amount.

use super::strokes::StrokeMeasures;
use serde::Serialize;

/// Maximum relative change from stroke 3 to stroke 4 for which both count as alike; also used by the claim
/// `closed-after-third`.
pub const ALIKE: f64 = 0.15;

/// Comparison of the heights of four peaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Peaks {
    /// `true` if the second is below the first.
    pub second_below_first: bool,
    /// `true` if the third and the fourth are above the first and the second.
    pub last_above_first: bool,
    /// `true` if the relative change from the third to the fourth is at most `ALIKE`.
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

    /// `true` if all comparisons match the text.
    pub fn whole(&self) -> bool {
        self.second_below_first && self.last_above_first && self.last_alike
    }
}

/// Comparison of a run's strokes with the paper's Fig. 8.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct StrokePattern {
    /// Comparison of the mean grasp force over MOVE.
    pub grasp_force: Peaks,
    /// Comparison of the peak torque.
    pub torque: Peaks,
}

impl StrokePattern {
    /// Compares strokes 1 to 4; `None` unless all are measured.
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

    /// `true` if stroke 2 is below stroke 1 in both quantities.
    pub fn second_below_first(&self) -> bool {
        self.grasp_force.second_below_first && self.torque.second_below_first
    }

    /// `true` if all comparisons match the text for both quantities.
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
            // The cap tightens in each stroke.
            ([1.0, 1.2, 1.4, 1.5], [false, true, true, false]),
            // The second is below the first, but so is the third.
            ([1.0, 0.6, 0.9, 1.0], [true, false, true, false]),
            // The fourth is not above the first.
            ([1.0, 0.6, 1.1, 1.0], [true, false, true, false]),
            // The fourth continues to rise, or falls.
            ([1.0, 0.6, 1.4, 1.7], [true, true, false, false]),
            ([1.0, 0.6, 1.7, 1.4], [true, true, false, false]),
            // Equal heights are neither above nor below.
            ([1.0, 1.0, 1.0, 1.0], [false, false, true, false]),
            // No positive torque.
            ([0.0, -1.0, 0.0, 0.0], [true, false, false, false]),
        ] {
            assert_eq!(parts(heights), expected, "{heights:?}");
        }
        let at_the_bound = Peaks::new([1.0, 0.5, 2.0, 2.0 * (1.0 + ALIKE)]);
        assert!(at_the_bound.last_alike);
    }
}
