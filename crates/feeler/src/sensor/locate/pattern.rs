//! Tests whether spots look like markers: evenly spaced and similar in size and contrast.

use super::{median, nearest, spot::Spot};
use glam::DVec2;

/// Minimum number of spots in a pattern.
const FEWEST: usize = 6;

/// Median deviation of spots from their six nearest neighbours, as logarithms of ratios; 0 for a perfect pattern.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Regularity {
    /// Deviation of the distance to the nearest spot.
    pub spacing: f64,
    /// Deviation of the diameter from the median of the nearest spots, as the logarithm of the ratio.
    pub size: f64,
    /// Deviation of the contrast.
    pub contrast: f64,
}

/// Returns the regularity of `spots`, or `None` if there are fewer than [`FEWEST`].
fn regularity(spots: &[Spot]) -> Option<Regularity> {
    if spots.len() < FEWEST {
        return None;
    }
    let centres: Vec<DVec2> = spots.iter().map(|s| s.centre).collect();
    let neighbours = nearest(&centres, 6);
    let gap = |i: usize| {
        neighbours[i]
            .first()
            .map_or(0.0, |&n| centres[i].distance(centres[n]))
    };
    let gaps: Vec<f64> = (0..spots.len()).map(gap).collect();
    let spread = |value: &dyn Fn(usize) -> f64| {
        let off = |own: usize| {
            let mut about: Vec<f64> = neighbours[own].iter().map(|&i| value(i)).collect();
            libm::log(value(own) / median(&mut about)).abs()
        };
        let mut off: Vec<f64> = (0..spots.len()).map(off).collect();
        median(&mut off)
    };
    Some(Regularity {
        spacing: spread(&|i| gaps[i]),
        size: spread(&|i| spots[i].diameter),
        contrast: spread(&|i| spots[i].contrast),
    })
}

/// Score of `spots` as a pattern: their total contrast over the irregularity of their spacing.
pub(super) fn score(spots: &[Spot]) -> f64 {
    /// Spacing irregularity assumed for too few spots: that of scattered points.
    const SCATTERED: f64 = 0.3;
    let spacing = regularity(spots).map_or(SCATTERED, |regularity| regularity.spacing);
    spots.iter().map(|spot| spot.contrast).sum::<f64>() / (0.05 + spacing)
}

/// A property in which spots differ from markers, with the measured value.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Unlike {
    /// The spacing of the spots varies.
    #[error("spacing differs by {:.0} % from spot to spot, expected at most {:.0} %", 100.0 * .0, 100.0 * SPACING)]
    Spacing(f64),
    /// The diameter of the spots varies.
    #[error("size differs by {:.0} % from spot to spot, expected at most {:.0} %", 100.0 * .0, 100.0 * SIZE)]
    Size(f64),
    /// The contrast of the spots varies.
    #[error("contrast differs by {:.0} % from spot to spot, expected at most {:.0} %", 100.0 * .0, 100.0 * CONTRAST)]
    Contrast(f64),
    /// The spots hardly differ from the background.
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

/// Maximum median deviations between neighbours. Scattered points deviate by 30 to 40 % in spacing; blobs of texture by
/// 13 % and more in size and 18 % and more in contrast. Pins, fibres and markers of real sensors, loaded or not,
/// deviate by at most 5 % in spacing, 7 % in size and 22 % in contrast.
const SPACING: f64 = 0.12;
const SIZE: f64 = 0.1;
const CONTRAST: f64 = 0.3;

/// Returns the properties in which `spots` differ from markers; `noise` is the image noise in gray levels.
pub(super) fn unlike_markers(spots: &[Spot], noise: f64) -> Vec<Unlike> {
    let Some(regularity) = regularity(spots) else {
        return Vec::new();
    };
    let mut contrasts: Vec<f64> = spots.iter().map(|spot| spot.contrast).collect();
    let (actual, expected) = (median(&mut contrasts), (6.0 * noise).max(4.0));
    let Regularity {
        spacing,
        size,
        contrast,
    } = regularity;
    let found = [
        (spacing > SPACING, Unlike::Spacing(spacing)),
        (size > SIZE, Unlike::Size(size)),
        (contrast > CONTRAST, Unlike::Contrast(contrast)),
        (actual < expected, Unlike::Faint { actual, expected }),
    ];
    found
        .into_iter()
        .filter_map(|(is, unlike)| is.then_some(unlike))
        .collect()
}
