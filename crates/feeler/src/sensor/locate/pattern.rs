//! Whether spots look like the markers of a sensor: evenly spaced, of similar size and contrast.

use super::{median, nearest, spots::Spot};
use glam::DVec2;

/// Fewer spots show no pattern.
const FEWEST: usize = 6;

/// How unlike their six nearest neighbours spots are, at the median; 0 for a perfect pattern.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Regularity {
    /// Of the distance to the nearest spot: the natural logarithm's deviation.
    pub spacing: f64,
    /// Of the diameter.
    pub size: f64,
    /// Of the contrast.
    pub contrast: f64,
}

/// The regularity of `spots`; `None` where they are too few to tell.
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
            (value(own) / median(&mut about)).ln().abs()
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

/// How much of a pattern `spots` are: their contrast, all together, over how irregularly they are spaced.
pub(super) fn score(spots: &[Spot]) -> f64 {
    /// Where spots are too few to tell, as irregular as scattered ones.
    const SCATTERED: f64 = 0.3;
    let spacing = regularity(spots).map_or(SCATTERED, |regularity| regularity.spacing);
    spots.iter().map(|spot| spot.contrast).sum::<f64>() / (0.05 + spacing)
}

/// What markers are and texture is not, with what was found instead.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Unlike {
    /// The distances from spot to spot differ.
    #[error("the spacing differs by {:.0} % from spot to spot, at most {:.0} % expected", 100.0 * .0, 100.0 * SPACING)]
    Spacing(f64),
    /// Their diameters differ.
    #[error("the size differs by {:.0} % from spot to spot, at most {:.0} % expected", 100.0 * .0, 100.0 * SIZE)]
    Size(f64),
    /// Their contrasts differ.
    #[error("the contrast differs by {:.0} % from spot to spot, at most {:.0} % expected", 100.0 * .0, 100.0 * CONTRAST)]
    Contrast(f64),
    /// They hardly differ from the ground.
    #[error(
        "the contrast is {actual:.1} gray levels, at least {expected:.1} expected for the picture's noise"
    )]
    Faint {
        /// Median contrast, grey levels.
        actual: f64,
        /// Least contrast, grey levels.
        expected: f64,
    },
}

/// Largest deviations from neighbour to neighbour, at the median. Scattered points are 30 to 40 % off, blobs of texture differ by
/// 13 % and more in size and by 18 % and more in contrast; pins, fibres and markers of real sensors, in contact or not, by no more than
/// 5, 7 and 22 %.
const SPACING: f64 = 0.12;
const SIZE: f64 = 0.1;
const CONTRAST: f64 = 0.3;

/// What of a pattern of markers `spots` lack, in a picture of which the noise is `noise` grey levels.
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
