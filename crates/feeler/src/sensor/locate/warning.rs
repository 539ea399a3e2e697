//! Warnings about located elements.

use super::{PatternDefect, error::list};
use glam::DVec2;

/// A possible problem with located elements.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LocateWarning {
    /// An element is much larger than its neighbours or has many more spots.
    #[error(
        "element {element} at column {:.1}, row {:.1} is {times:.1} times as large as its neighbours: two elements may have merged",
        centre_px.x, centre_px.y
    )]
    Merged {
        /// Index of the element.
        element: usize,
        /// Centre of the element, px.
        centre_px: DVec2,
        /// Ratio of its area to its neighbours', or of its number of spots to the typical number.
        times: f64,
    },
    /// An element has fewer spots than the others.
    #[error("element {element} has {actual} spots, expected {expected} as for the others")]
    Incomplete {
        /// Index of the element.
        element: usize,
        /// Typical number of spots per element.
        expected: usize,
        /// Number of spots of this element.
        actual: usize,
    },
    /// Most of an element's pixels are saturated.
    #[error(
        "{} of the elements are saturated (the first is {}): lower exposure or gain, since a force cannot change a saturated gray value",
        elements.len(), elements.first().copied().unwrap_or(0)
    )]
    Saturated {
        /// Indices of the elements.
        elements: Vec<usize>,
    },
    /// All pixels are black or white.
    #[error(
        "the images have only two gray levels, black and white: integrated gray values count pixels, and saturation cannot be detected"
    )]
    TwoLevels,
    /// Spots that do not belong to an element because their position, size or contrast does not match the pattern, or
    /// because they belong to no group.
    #[error(
        "{} spots are ignored because their place, size or contrast is unlike the pattern's (the first at column {:.0}, row {:.0})",
        spots_px.len(), spots_px.first().map_or(0.0, |s| s.x), spots_px.first().map_or(0.0, |s| s.y)
    )]
    LeftOut {
        /// Positions of the spots, px.
        spots_px: Vec<DVec2>,
    },
    /// Spots that are cut by the image border, so that their centroids would be wrong.
    #[error(
        "{} spots are ignored because the image border cuts them (the first at column {:.0}, row {:.0})",
        spots_px.len(), spots_px.first().map_or(0.0, |s| s.x), spots_px.first().map_or(0.0, |s| s.y)
    )]
    AtBorder {
        /// Positions of the spots, px.
        spots_px: Vec<DVec2>,
    },
    /// The spots are not a regular pattern of markers in some property.
    #[error("check that these spots are markers: {}", list(defects))]
    IrregularPattern {
        /// Properties that are irregular.
        defects: Vec<PatternDefect>,
    },
    /// Sub-regions are clipped at the image border.
    #[error(
        "{} sub-regions extend beyond the image and are clipped (the first belongs to element {})",
        elements.len(), elements.first().copied().unwrap_or(0)
    )]
    CutOff {
        /// Indices of the elements.
        elements: Vec<usize>,
    },
}
