//! `identify.html`: what a probing run says about a hand and its object.

use super::document::document;
use super::figures::identify::{circle_figure, depth_figure, shear_figure, slide_figure};
use super::page_data::PageData;
use super::text::significant;
use maud::{Markup, html};

/// What the page shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct IdentifyPage {
    /// Name of the experiment.
    pub experiment: String,
    /// Seed of the probing run.
    pub seed: u64,
    /// Findings that need attention, one sentence each.
    pub warnings: Vec<String>,
    /// Every estimate.
    pub rows: Vec<EstimateRow>,
    /// Raw probes of each finger, with what was fitted to them.
    pub fingers: Vec<FingerProbes>,
    /// Centre and radius of the circle through the tips, m, x and y in W.
    pub circle: [f64; 3],
}

/// An estimate as the page shows it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EstimateRow {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// "object", or the finger.
    pub of: String,
    /// Its unit.
    pub unit: &'static str,
    /// Best estimate and the ends of its 95 % interval, in that unit.
    pub value: [f64; 3],
    /// How it was estimated.
    pub method: String,
}

/// Raw probes of one finger.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FingerProbes {
    /// Depth (m) and `F_z` (N) of its most loaded contact.
    pub depth: Vec<(f64, f64)>,
    /// Shear displacement (m) and shear force (N) of the same contact.
    pub shear: Vec<(f64, f64)>,
    /// Stiffness along and across, N/m.
    pub stiffness: [f64; 2],
    /// Time (s) and ratio of shear to normal force in each slide.
    pub slides: Vec<Vec<(f64, f64)>>,
    /// Coefficients of static and kinetic friction.
    pub friction: [f64; 2],
    /// Tips of its touching elements, m, x and y in W.
    pub tips: Vec<(f64, f64)>,
}

/// The page, as HTML text.
pub fn identify_page(page: &IdentifyPage) -> String {
    let figures = vec![
        depth_figure(page, 1),
        shear_figure(page, 2),
        slide_figure(page, 3),
        circle_figure(page, 4),
    ];
    let title = format!("Identified: {}, seed {}", page.experiment, page.seed);
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
