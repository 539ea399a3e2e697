//! Common HTML document of all report pages: self-contained, for phone, desktop and print.

use crate::figures::Figure;
use crate::page_data::PageData;
use maud::{DOCTYPE, Markup, PreEscaped, Render, html};

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

/// Document of a page whose data are only its figures.
pub fn document_of_figures(title: &str, body: Markup, figures: &[Figure]) -> String {
    document(title, body, &PageData::of_figures(title, figures))
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

/// A table that scrolls sideways on narrow screens, from its header cells and the cells of each row.
pub fn table(head: Markup, rows: impl IntoIterator<Item = Markup>) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr { (head) } }
                tbody { @for row in rows { tr { (row) } } }
            }
        }
    }
}

/// A table of names and values.
pub fn facts_table(facts: impl IntoIterator<Item = (impl Render, impl Render)>) -> Markup {
    html! {
        table {
            tbody { @for (name, value) in facts { tr { th scope="row" { (name) } td { (value) } } } }
        }
    }
}

/// Header cells of numeric columns.
pub fn number_heads(names: impl IntoIterator<Item = impl Render>) -> Markup {
    html! { @for name in names { th.number { (name) } } }
}

/// Numeric cells of a row.
pub fn numbers(values: impl IntoIterator<Item = impl Render>) -> Markup {
    html! { @for value in values { td.number { (value) } } }
}

/// Figures side by side, space permitting.
pub fn figures(figures: &[Figure]) -> Markup {
    html! { div.figures { @for figure in figures { (figure.markup()) } } }
}

/// A text that is initially folded.
pub fn folded(summary: &str, text: &str) -> Markup {
    html! {
        details {
            summary { (summary) }
            pre { (text) }
        }
    }
}

/// Banner if not all planned trials are completed.
pub fn incomplete(finished: u64, planned: u64, completed: &str) -> Markup {
    html! {
        @if finished < planned {
            div.incomplete role="alert" { "INCOMPLETE: " (finished) " of " (planned) " trials are " (completed) "." }
        }
    }
}
