//! Common HTML document of all report pages: self-contained, for phone, desktop and print.

use crate::page_data::PageData;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("../page.css");

/// The page's script, built from `web/`.
const PROGRAM: &str = include_str!("../page.js");

/// Complete HTML document with title, body and the data of its script.
pub fn document(title: &str, body: Markup, page: &PageData) -> String {
    // Without data, the script shows an error on the page.
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

/// A key figure at the top of a page.
pub struct Tile {
    value: String,
    unit: String,
    label: String,
}

impl Tile {
    /// A value, its unit and its label.
    pub fn new(value: String, unit: impl Into<String>, label: impl Into<String>) -> Self {
        let (unit, label) = (unit.into(), label.into());
        Self { value, unit, label }
    }
}

/// The row of key figures at the top of a page.
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
