//! Live page of a running rig.

use super::document::document;
use crate::page_data::PageData;
pub use crate::page_data::{Live, LiveRig};
use maud::html;

/// Renders the live page of `rig` as HTML.
pub fn live_page(title: &str, rig: &LiveRig<'_>, live: Live) -> String {
    let figures = || rig.figures().into_iter().zip(1..);
    let body = html! {
        h1 { "Live: " (title) }
        div id="live" {}
        div id="scene" {}
        h2 { "Figures" }
        div.figures {
            @for ((title, _), number) in figures() {
                figure id=(format!("fig-{number:02}")) {
                    figcaption { b { "Fig. " (number) ". " (title) ". " } "Latest data." }
                }
            }
        }
    };
    document(title, body, &PageData::of_rig(title, rig, live))
}
