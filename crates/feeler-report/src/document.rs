//! What every page of a report is: one self-contained document for phone, desk and print.

use super::page_data::PageData;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("page.css");

/// The page's program, made of `web/`.
const PROGRAM: &str = include_str!("page.js");

/// The document called `title` with what its program draws, as HTML text.
pub fn document(title: &str, body: Markup, page: &PageData) -> String {
    // Without its data, the program says so on the page.
    let data = page.to_json().unwrap_or_default();
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                (body)
                script type="application/json" id="page-data" { (PreEscaped(data)) }
                script { (PreEscaped(PROGRAM)) }
            }
        }
    }
    .into_string()
}

/// A number that a page begins with.
pub struct Tile {
    value: String,
    unit: String,
    label: String,
}

impl Tile {
    /// A value in its unit, and what it is.
    pub fn new(value: String, unit: impl Into<String>, label: impl Into<String>) -> Self {
        let (unit, label) = (unit.into(), label.into());
        Self { value, unit, label }
    }
}

/// The numbers that a page begins with.
pub fn tiles(tiles: &[Tile]) -> Markup {
    html! {
        div.tiles {
            @for Tile { value, unit, label } in tiles {
                div.tile {
                    div.value { (value) @if !unit.is_empty() { " " span.unit { (unit) } } }
                    div.label { (label) }
                }
            }
        }
    }
}
