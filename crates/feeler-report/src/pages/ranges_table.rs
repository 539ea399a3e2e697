//! Table of parameters that vary over plausible ranges.

use super::document::table;
use maud::{Markup, html};
use serde::Serialize;

/// Range of one varied parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RangeRow {
    /// Parameter name.
    pub name: String,
    /// Parameter group.
    pub group: String,
    /// Unit of the range.
    pub unit: String,
    /// Keys that the parameter sets.
    pub keys: Vec<String>,
    /// Key whose value is multiplied by the drawn value, if any.
    pub of: Option<String>,
    /// Exponent of the value of the key `of`; 1 if `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub power: Option<f64>,
    /// Range as written in the experiment file.
    pub range: String,
    /// Ends of the range, or the choices.
    pub ends: Vec<String>,
    /// Nominal value in the experiment.
    pub nominal: String,
    /// Reason why the range is plausible.
    pub why: String,
}

/// Table with one row per parameter.
pub(crate) fn ranges_table(ranges: &[RangeRow]) -> Markup {
    let head = html! { th { "Parameter" } th { "Group" } th { "Range" } th.number { "Experiment" } th { "Reason" } };
    let rows = ranges.iter().map(|row| {
        html! {
            td { (row.name) @if !row.unit.is_empty() { " " span.unit { (row.unit) } } }
            td { (row.group) }
            td { code { (row.range) } (multiplier(row)) }
            td.number { (short(&row.nominal)) }
            td { (row.why) }
        }
    });
    table(head, rows)
}

/// Factor by which the range is multiplied, if any.
fn multiplier(row: &RangeRow) -> Markup {
    html! {
        @if let Some(of) = &row.of { " × " code { (of) } @if let Some(power) = row.power { sup { (power) } } }
    }
}

/// Rounds a number to four significant digits; returns other text unchanged.
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
