//! `identify.html`: results of a probing run for a hand and its object.

use super::document::document;
use super::text::significant;
use crate::figures::identify::{circle_figure, depth_figure, shear_figure, slide_figure};
use crate::page_data::PageData;
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

/// Raw probes of one finger.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FingerProbes {
    /// Depth (m) and `F_z` (N) of the most loaded contact.
    pub depth: Vec<(f64, f64)>,
    /// Shear displacement (m) and shear force (N) of the same contact.
    pub shear: Vec<(f64, f64)>,
    /// Normal and tangential stiffness (N/m).
    pub stiffness: [f64; 2],
    /// For each slide: time (s) and ratio of shear to normal force.
    pub slides: Vec<Vec<(f64, f64)>>,
    /// Coefficients of static and kinetic friction.
    pub friction: [f64; 2],
    /// Tips of the touching elements: x, y in W (m).
    pub tips: Vec<(f64, f64)>,
}

/// Renders the page as HTML.
pub fn identify_page(page: &IdentifyPage) -> String {
    let figures = vec![
        depth_figure(page, 1),
        shear_figure(page, 2),
        slide_figure(page, 3),
        circle_figure(page, 4),
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
        div.figures { @for figure in &figures { (figure.markup()) } }
    };
    document(&title, body, &PageData::of_figures(&title, &figures))
}

fn estimates_table(page: &IdentifyPage) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr { th { "Quantity" } th { "Of" } th.number { "Estimate" } th.number { "95 % interval" } th { "Method" } } }
                tbody {
                    @for row in &page.rows {
                        tr {
                            td { (row.quantity) }
                            td { (row.of) }
                            td.number { (significant(row.value[0])) " " span.unit { (row.unit) } }
                            td.number { (significant(row.value[1])) " to " (significant(row.value[2])) }
                            td { (row.method) }
                        }
                    }
                }
            }
        }
    }
}
