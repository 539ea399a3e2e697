//! What varied over plausible ranges, as a table of a page.

use maud::{Markup, html};
use serde::Serialize;

/// What one parameter was drawn from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RangeRow {
    /// Its name.
    pub name: String,
    /// Its group.
    pub group: String,
    /// Its unit.
    pub unit: String,
    /// The keys that it sets.
    pub keys: Vec<String>,
    /// The key that it is a multiple of.
    pub of: Option<String>,
    /// The power to which that key's value is raised, 1 if `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub power: Option<f64>,
    /// Its range, as written.
    pub range: String,
    /// The ends of its range, or its choices.
    pub ends: Vec<String>,
    /// What the experiment has.
    pub nominal: String,
    /// Why the range is plausible.
    pub why: String,
}

/// A row for each parameter.
pub(crate) fn ranges_table(ranges: &[RangeRow]) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr { th { "Parameter" } th { "Group" } th { "Range" } th.number { "Experiment" } th { "Why" } } }
                tbody {
                    @for row in ranges {
                        tr {
                            td { (row.name) @if !row.unit.is_empty() { " " span.unit { (row.unit) } } }
                            td { (row.group) }
                            td { code { (row.range) } (multiplier(row)) }
                            td.number { (short(&row.nominal)) }
                            td { (row.why) }
                        }
                    }
                }
            }
        }
    }
}

/// What a range is multiplied with.
fn multiplier(row: &RangeRow) -> Markup {
    html! {
        @if let Some(of) = &row.of { " × " code { (of) } @if let Some(power) = row.power { sup { (power) } } }
    }
}

/// A number with four digits that count; other text as it is.
fn short(text: &str) -> String {
    let number: Option<f64> = text.parse().ok();
    number.map_or_else(
        || text.to_string(),
        |number| {
            let rounded: f64 = format!("{number:.3e}").parse().unwrap_or(number);
            rounded.to_string()
        },
    )
}
