//! Colours, and how lines are drawn.

/// Black, of what belongs to the cap.
pub const CAP: &str = "#000000";
/// Colours of the fingers (Okabe and Ito's, safe for the colour-blind).
const FINGERS: [&str; 5] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9"];
/// Colours of successive strokes, from the first to the last (plasma, which grows darker evenly, for
/// the colour-blind, too).
const STROKES: [&str; 6] = [
    "#F1962F", "#E16462", "#C03A83", "#8F0DA4", "#5901A5", "#0D0887",
];
/// Grey of what was planned, or is allowed.
pub const REFERENCE: &str = "#555555";
/// Grey of grids and shades.
pub const SHADE: &str = "#d9d9d9";

/// Colour of a finger.
pub fn finger_colour(finger: usize) -> &'static str {
    FINGERS[finger % FINGERS.len()]
}

/// Colour of a stroke, the `place`th (from 0) of `count`; some share one where there are many.
pub fn stroke_colour(place: usize, count: usize) -> &'static str {
    let last = count.saturating_sub(1).max(1);
    STROKES[(place * (STROKES.len() - 1) / last).min(STROKES.len() - 1)]
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pen {
    /// Colour, as in CSS.
    pub colour: &'static str,
    /// Width.
    pub width: f64,
    /// Whether it is broken.
    pub style: Style,
}

/// Whether and how a line is broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Not at all.
    Solid,
    /// Into dashes.
    Dashed,
    /// Into dots.
    Dotted,
}

impl Style {
    /// As SVG has it.
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
