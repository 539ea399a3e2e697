//! `identify.html`: results of a probing run for a hand and its object.

use super::document::{document_of_figures, figures, table};
use super::text::significant;
use crate::figures::identify::{
    FingerProbes, circle_figure, depth_figure, shear_figure, slide_figure,
};
use maud::{Markup, html};

/// Content of the identification page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct IdentifyPage {
    /// Name of the experiment.
    pub experiment: String,
    /// Seed of the probing run.
    pub seed: u64,
    /// Findings that need attention, one sentence each.
    pub warnings: Vec<String>,
    /// All estimates.
    pub rows: Vec<EstimateRow>,
    /// Raw probes of each finger, with the fits.
    pub fingers: Vec<FingerProbes>,
    /// Circle through the tips: centre x, y in W and radius (m).
    pub circle: [f64; 3],
}

/// A row of the table of estimates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EstimateRow {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// "object" or the finger's name.
    pub of: String,
    /// Unit of the value.
    pub unit: &'static str,
    /// Estimate and ends of its 95 % interval, in that unit.
    pub value: [f64; 3],
    /// Estimation method.
    pub method: String,
}

/// Renders the page as HTML.
pub fn identify_page(page: &IdentifyPage) -> String {
    let drawn = [
        depth_figure(&page.fingers, 1),
        shear_figure(&page.fingers, 2),
        slide_figure(&page.fingers, 3),
        circle_figure(&page.fingers, page.circle, 4),
    ];
    let title = format!("Identification: {}, seed {}", page.experiment, page.seed);
    let body = html! {
        h1 { (title) }
        @if page.warnings.is_empty() {
            p.verdict { "No warnings." }
        } @else {
            h2 { "Warnings" }
            ul { @for warning in &page.warnings { li { (warning) } } }
        }
        h2 { "Estimates" }
        (estimates_table(page))
        h2 { "Probes and fits" }
        (figures(&drawn))
    };
    document_of_figures(&title, body, &drawn)
}

fn estimates_table(page: &IdentifyPage) -> Markup {
    let head = html! { th { "Quantity" } th { "Of" } th.number { "Estimate" } th.number { "95 % interval" } th { "Method" } };
    let rows = page.rows.iter().map(|row| {
        html! {
            td { (row.quantity) }
            td { (row.of) }
            td.number { (significant(row.value[0])) " " span.unit { (row.unit) } }
            td.number { (significant(row.value[1])) " to " (significant(row.value[2])) }
            td { (row.method) }
        }
    });
    table(head, rows)
}
