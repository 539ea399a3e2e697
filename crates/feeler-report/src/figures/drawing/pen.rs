//! Colours and line styles.

/// Black, for the cap.
pub const CAP: &str = "#000000";
/// Colours of the fingers (Okabe and Ito, safe for colour-blind readers).
const FINGERS: [&str; 5] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9"];
/// Colours of successive strokes (colour map plasma, perceptually uniform and safe for colour-blind readers).
const STROKES: [&str; 6] = [
    "#F1962F", "#E16462", "#C03A83", "#8F0DA4", "#5901A5", "#0D0887",
];
/// Gray of planned values and limits.
pub const REFERENCE: &str = "#555555";
/// Gray of grids and shading.
pub const SHADE: &str = "#d9d9d9";

/// Colour of a finger.
pub fn finger_colour(finger: usize) -> &'static str {
    FINGERS[finger % FINGERS.len()]
}

/// Colour of the stroke with index `place` among `count` strokes; many strokes share colours.
pub fn stroke_colour(place: usize, count: usize) -> &'static str {
    let last = count.saturating_sub(1).max(1);
    STROKES[(place * (STROKES.len() - 1) / last).min(STROKES.len() - 1)]
}

/// Line style of a plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pen {
    /// CSS color.
    pub colour: &'static str,
    /// Line width.
    pub width: f64,
    /// Solid, dashed or dotted.
    pub style: Style,
}

/// Dash pattern of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Continuous line.
    Solid,
    /// Dashed line.
    Dashed,
    /// Dotted line.
    Dotted,
}

impl Style {
    /// Value of the SVG attribute `stroke-dasharray`.
    pub fn dashes(self) -> Option<&'static str> {
        match self {
            Self::Solid => None,
            Self::Dashed => Some("6 4"),
            Self::Dotted => Some("2 3"),
        }
    }
}

impl Pen {
    /// A solid line.
    pub const fn solid(colour: &'static str, width: f64) -> Self {
        Self {
            colour,
            width,
            style: Style::Solid,
        }
    }

    /// A dashed line.
    pub const fn dashed(colour: &'static str, width: f64) -> Self {
        Self {
            style: Style::Dashed,
            ..Self::solid(colour, width)
        }
    }

    /// A dotted line.
    pub const fn dotted(colour: &'static str, width: f64) -> Self {
        Self {
            style: Style::Dotted,
            ..Self::solid(colour, width)
        }
    }
}
