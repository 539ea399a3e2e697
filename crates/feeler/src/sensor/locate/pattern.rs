//! Tests whether spots can be markers: evenly spaced and similar in size and contrast.

use super::strays::{centres, gaps};
use super::{median, median_of, nearest, spot::Spot};

/// Minimum number of spots in a pattern.
const FEWEST: usize = 6;

/// Irregularity of spots: median deviation from their six nearest neighbours, as logarithms of ratios; 0 for a perfect
/// pattern.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Regularity {
    /// Deviation of the distance to the nearest spot.
    pub spacing: f64,
    /// Deviation of the diameter from the median of the nearest spots.
    pub size: f64,
    /// Deviation of the contrast.
    pub contrast: f64,
}

/// Returns the regularity of `spots`, or `None` if there are fewer than [`FEWEST`].
fn regularity(spots: &[Spot]) -> Option<Regularity> {
    if spots.len() < FEWEST {
        return None;
    }
    let neighbours = nearest(&centres(spots), 6);
    let gaps = gaps(spots, &neighbours);
    let spread = |value: &dyn Fn(usize) -> f64| {
        let off = |own: usize| libm::log(value(own) / median_of(&neighbours[own], value)).abs();
        let mut off: Vec<f64> = (0..spots.len()).map(off).collect();
        median(&mut off)
    };
    Some(Regularity {
        spacing: spread(&|i| gaps[i]),
        size: spread(&|i| spots[i].diameter),
        contrast: spread(&|i| spots[i].contrast),
    })
}

/// Score of `spots` as a pattern: total contrast divided by the irregularity of the spacing.
pub(super) fn score(spots: &[Spot]) -> f64 {
    /// Irregularity of the spacing assumed if there are too few spots: that of scattered points.
    const UNKNOWN: f64 = 0.3;
    let spacing = regularity(spots).map_or(UNKNOWN, |regularity| regularity.spacing);
    spots.iter().map(|spot| spot.contrast).sum::<f64>() / (0.05 + spacing)
}

/// Property by which spots are not a regular pattern of markers, with the measured value.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PatternDefect {
    /// There are too few spots to distinguish a pattern from specks.
    #[error("expected at least {FEWEST} spots, got {0}")]
    Few(usize),
    /// The spacing of the spots varies too much.
    #[error("spacing differs by {:.0} % from spot to spot, expected at most {:.0} %", 100.0 * .0, 100.0 * SCATTERED)]
    Spacing(f64),
    /// The diameter of the spots varies too much.
    #[error("size differs by {:.0} % from spot to spot, expected at most {:.0} %", 100.0 * .0, 100.0 * SIZE)]
    Size(f64),
    /// The contrast of the spots varies too much.
    #[error("contrast differs by {:.0} % from spot to spot, expected at most {:.0} %", 100.0 * .0, 100.0 * CONTRAST)]
    Contrast(f64),
    /// The sum of the deviations in spacing, size and contrast, each divided by its maximum, is too large; faint spots
    /// add 1.
    #[error("the sum of these differences, each divided by its maximum, is {:.1}, expected at most {:.0}", .0, TOTAL)]
    Total(f64),
    /// The contrast of the spots is too low for the image noise.
    #[error(
        "contrast is {actual:.1} gray levels, expected at least {expected:.1} for this image noise"
    )]
    Faint {
        /// Median contrast, gray levels.
        actual: f64,
        /// Minimum contrast, gray levels.
        expected: f64,
    },
}

/// Maximum median deviation of the spacing between neighbouring spots of a pattern. It is 30 to 40 % for scattered
/// points, 10 % for blobs of texture, and at most 4 % for pins, fibres and markers of real sensors, loaded or not.
const SPACING: f64 = 0.12;
/// Maximum median deviation of the size. It is 25 % for blobs of texture, and at most 8 % for real sensors.
const SIZE: f64 = 0.1;
/// Maximum median deviation of the contrast. It is 20 % for blobs of texture, and at most 25 % for real sensors.
const CONTRAST: f64 = 0.3;

/// Deviation in spacing above which spots are considered scattered, regardless of size and contrast: twice that of real
/// sensors.
const SCATTERED: f64 = 0.08;

/// Maximum sum of the deviations, each divided by its own maximum. Real sensors reach at most 1.3; texture and
/// scattered specks at least 2.5.
const TOTAL: f64 = 2.0;

/// Result of assessing whether spots are markers.
pub(super) enum Assessment {
    /// The spots are markers, with the properties that exceed their individual maximum.
    Pattern(Vec<PatternDefect>),
    /// The spots are not markers because of these properties.
    NoPattern(Vec<PatternDefect>),
}

/// Decides whether `spots` are markers by their number, spacing, size and contrast. `noise` is the image noise in gray
/// levels.
pub(super) fn assess(spots: &[Spot], noise: f64) -> Assessment {
    let Some(regularity) = regularity(spots) else {
        return Assessment::NoPattern(vec![PatternDefect::Few(spots.len())]);
    };
    let mut contrasts: Vec<f64> = spots.iter().map(|spot| spot.contrast).collect();
    let (actual, expected) = (median(&mut contrasts), (6.0 * noise).max(4.0));
    let Regularity {
        spacing,
        size,
        contrast,
    } = regularity;
    let measured = [
        (spacing / SPACING, PatternDefect::Spacing(spacing)),
        (size / SIZE, PatternDefect::Size(size)),
        (contrast / CONTRAST, PatternDefect::Contrast(contrast)),
        // A contrast below its minimum counts as much as a deviation at its maximum.
        (
            if actual < expected { 1.0 } else { 0.0 },
            PatternDefect::Faint { actual, expected },
        ),
    ];
    let total: f64 = measured.iter().map(|(part, _)| part).sum();
    let at_least = |least: f64| {
        let found = measured.iter().filter(move |(part, _)| *part >= least);
        found.map(|&(_, defects)| defects)
    };
    // Scattered spots of equal size and contrast differ in their spacing alone.
    if total <= TOTAL && spacing <= SCATTERED {
        Assessment::Pattern(at_least(1.0).collect())
    } else {
        let total = (total > TOTAL).then_some(PatternDefect::Total(total));
        Assessment::NoPattern(at_least(0.25 * TOTAL).chain(total).collect())
    }
}
