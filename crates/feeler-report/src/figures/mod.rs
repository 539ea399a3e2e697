//! Figures of reports: the paper's Figs. 8 to 13, an additional Fig. 14, and figures of other tasks and pages.

pub mod calibration;
pub mod cap;
pub mod compare;
pub mod drawing;
pub mod friction;
mod friction_samples;
mod from_above;
pub mod identify;
pub mod law_shares;
pub(crate) mod outline;
pub mod paths;
pub mod radius;
pub mod robustness;
pub mod slip;
mod slip_strip;
pub mod sweep;
pub mod time;
mod unrolled;
pub mod wrench;

use crate::figures::drawing::sheet::Drawing;
use crate::page_data::panels::Panel;
use maud::{Markup, PreEscaped, html};

/// A figure of a page.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Figure number; equals the paper's number for figures that correspond to the paper.
    pub number: u32,
    /// Title.
    pub title: String,
    /// Explanation, including the relation to the paper's figure.
    pub caption: String,
    /// Static figure as SVG document; `None` if the recording does not contain the data.
    pub svg: Option<String>,
    /// Interactive panels that replace the static figure; may be empty.
    pub panels: Vec<Panel>,
    /// Number of panels side by side, space permitting.
    pub columns: usize,
}

impl Figure {
    /// A figure that shows `drawing`, or a placeholder if it is `None`.
    pub(super) fn drawn(
        number: u32,
        title: impl Into<String>,
        caption: impl Into<String>,
        drawing: Option<Drawing>,
    ) -> Self {
        let missing = Self::missing(number, title, caption);
        let Some(drawing) = drawing else {
            return missing;
        };
        Self {
            svg: Some(drawing.svg),
            panels: drawing.panels,
            columns: drawing.columns,
            ..missing
        }
    }

    /// A static figure.
    pub(super) fn still(
        number: u32,
        title: impl Into<String>,
        caption: impl Into<String>,
        svg: String,
    ) -> Self {
        Self {
            svg: Some(svg),
            ..Self::missing(number, title, caption)
        }
    }

    /// A placeholder.
    fn missing(number: u32, title: impl Into<String>, caption: impl Into<String>) -> Self {
        Self {
            number,
            title: title.into(),
            caption: caption.into(),
            svg: None,
            panels: Vec::new(),
            columns: 1,
        }
    }

    /// HTML of the figure; its panels find it by number.
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

    /// Name of the figure's SVG file.
    pub fn file_name(&self) -> String {
        format!("fig-{:02}.svg", self.number)
    }
}
