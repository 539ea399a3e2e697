//! What a person should look at in a picture in which elements were located all the same.

use super::{Unlike, error::list};
use glam::DVec2;

/// What looks wrong but need not be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LocateWarning {
    /// An element is much larger than those about it, or holds more spots.
    #[error(
        "element {element} at column {:.1}, row {:.1} is {times:.1} times as large as its neighbours: two elements merged?",
        centre_px.x, centre_px.y
    )]
    Merged {
        /// Its index.
        element: usize,
        /// Its centre, px.
        centre_px: DVec2,
        /// Its area, or number of spots, over its neighbours'.
        times: f64,
    },
    /// An element has fewer spots than the others.
    #[error("element {element} has {actual} spots, the others have {expected}")]
    Incomplete {
        /// Its index.
        element: usize,
        /// Spots of most elements.
        expected: usize,
        /// Spots that it has.
        actual: usize,
    },
    /// Most of an element's spot is as bright as a pixel can be.
    #[error(
        "{} of the elements are saturated (the first is {}): lower exposure or gain, for there a force changes no gray value",
        elements.len(), elements.first().copied().unwrap_or(0)
    )]
    Saturated {
        /// Their indices.
        elements: Vec<usize>,
    },
    /// All pixels are black or white.
    #[error(
        "the pictures have only two gray levels, black and white: an integrated gray value counts pixels, and saturation cannot be told"
    )]
    TwoLevels,
    /// Spots that are no elements: they stand apart, or are part of no group.
    #[error(
        "{} spots are left out, as they stand apart from the elements (the first at column {:.0}, row {:.0})",
        spots_px.len(), spots_px.first().map_or(0.0, |s| s.x), spots_px.first().map_or(0.0, |s| s.y)
    )]
    LeftOut {
        /// Where they are, px.
        spots_px: Vec<DVec2>,
    },
    /// Spots that the picture's border cuts: the centroid of what is seen would be wrong.
    #[error(
        "{} spots are left out, as the picture's border cuts them (the first at column {:.0}, row {:.0})",
        spots_px.len(), spots_px.first().map_or(0.0, |s| s.x), spots_px.first().map_or(0.0, |s| s.y)
    )]
    AtBorder {
        /// Where they are, px.
        spots_px: Vec<DVec2>,
    },
    /// The spots lack something that a pattern of markers has.
    #[error("do these spots look like markers? {}", list(unlike))]
    Unlike {
        /// What they lack.
        unlike: Vec<Unlike>,
    },
    /// Sub-regions are cut off by the picture's rim.
    #[error(
        "{} of the sub-regions reach beyond the picture and are cut off (the first is of element {})",
        elements.len(), elements.first().copied().unwrap_or(0)
    )]
    CutOff {
        /// Indices of their elements.
        elements: Vec<usize>,
    },
}
