//! What every page of a report is: one self-contained document for phone, desk and print.

use super::page_data::PageData;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("page.css");

/// The page's program, made of `web/`.
const PROGRAM: &str = include_str!("page.js");

/// The document called `title`, as HTML text.
pub fn document(title: &str, body: Markup) -> String {
    whole(title, body, html! {})
}

/// The same with what its program draws.
pub fn document_with(title: &str, body: Markup, page: &PageData) -> String {
    // Without its data, the program says so on the page.
    let data = page.to_json().unwrap_or_default();
    let program = html! {
        script type="application/json" id="page-data" { (PreEscaped(data)) }
        script { (PreEscaped(PROGRAM)) }
    };
    whole(title, body, program)
}

fn whole(title: &str, body: Markup, program: Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { (body) (program) }
        }
    }
    .into_string()
}

/// A number that a page begins with.
pub struct Tile {
    value: String,
    unit: &'static str,
    label: &'static str,
}

impl Tile {
    /// A value in its unit, and what it is.
    pub fn new(value: String, unit: &'static str, label: &'static str) -> Self {
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
