//! Figures, drawn from a run: the paper's Figs. 8 to 13, one that goes with them, and those of other tasks.

pub mod calibration;
pub(super) mod canvas;
pub mod cap;
pub mod compare;
pub(super) mod drawing;
pub mod friction;
mod friction_samples;
mod from_above;
mod grid;
pub mod outline;
pub mod paths;
mod pen;
pub mod radius;
pub mod robustness;
pub mod slip;
mod slip_strip;
pub mod sweep;
pub mod time;
mod unrolled;

use super::page_data::Panel;
use drawing::Drawing;

/// One figure of the report.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Its number; where it answers a figure of the paper, that figure's.
    pub number: u32,
    /// What it shows.
    pub title: String,
    /// What to see in it, and how that relates to the paper's figure.
    pub caption: String,
    /// The picture, a whole SVG document; none if the recording does not hold what it shows.
    pub svg: Option<String>,
    /// What stands in its place where scripts run; nothing if the picture stays.
    pub panels: Vec<Panel>,
}

impl Figure {
    /// A figure that shows `drawing`, if the recording holds it.
    pub(super) fn drawn(
        number: u32,
        title: impl Into<String>,
        caption: impl Into<String>,
        drawing: Option<Drawing>,
    ) -> Self {
        let (svg, panels) = drawing.map(|drawing| (drawing.svg, drawing.panels)).unzip();
        Self {
            number,
            title: title.into(),
            caption: caption.into(),
            svg,
            panels: panels.unwrap_or_default(),
        }
    }

    /// Name of the figure's file.
    pub fn file_name(&self) -> String {
        format!("fig-{:02}.svg", self.number)
    }
}
