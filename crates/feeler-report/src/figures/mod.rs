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
pub mod identify;
pub mod law_shares;
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
pub mod wrench;

use super::page_data::Panel;
use drawing::Drawing;
use maud::{Markup, PreEscaped, html};

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
    /// How many panels stand side by side, where there is room.
    pub columns: usize,
}

impl Figure {
    /// A figure that shows `drawing`, if the recording holds it.
    pub(super) fn drawn(
        number: u32,
        title: impl Into<String>,
        caption: impl Into<String>,
        drawing: Option<Drawing>,
    ) -> Self {
        let (title, caption) = (title.into(), caption.into());
        let Some(Drawing {
            svg,
            panels,
            columns,
        }) = drawing
        else {
            return Self::missing(number, title, caption);
        };
        Self {
            number,
            title,
            caption,
            svg: Some(svg),
            panels,
            columns,
        }
    }

    /// A figure that is a picture only.
    pub(super) fn still(
        number: u32,
        title: impl Into<String>,
        caption: impl Into<String>,
        svg: String,
    ) -> Self {
        Self {
            svg: Some(svg),
            ..Self::missing(number, title.into(), caption.into())
        }
    }

    fn missing(number: u32, title: String, caption: String) -> Self {
        Self {
            number,
            title,
            caption,
            svg: None,
            panels: Vec::new(),
            columns: 1,
        }
    }

    /// The figure in a page, where its panels find it by its number.
    pub(super) fn markup(&self) -> Markup {
        html! {
            figure id=(format!("fig-{:02}", self.number)) {
                @match &self.svg {
                    Some(svg) => (PreEscaped(svg)),
                    None => div.missing { "Not in this recording." },
                }
                figcaption {
                    b { "Fig. " (self.number) ". " (self.title) ". " }
                    (self.caption)
                }
            }
        }
    }

    /// Name of the figure's file.
    pub fn file_name(&self) -> String {
        format!("fig-{:02}.svg", self.number)
    }
}
