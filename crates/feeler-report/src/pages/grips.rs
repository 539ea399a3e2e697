//! `compare.html` of a gripper: laws of the grip force compared on the same unknown objects.

use super::document::{document_of_figures, figures, number_heads, numbers, table};
use crate::figures::compare::{Curves, curves_figure};
use maud::html;

/// Column headings of a law.
pub const GRIP_COLUMNS: [&str; 9] = [
    "dropped (%)",
    "crushed (%)",
    "dropped or crushed (%)",
    "mean grip / least that held",
    "mean grip / load over 2 μ",
    "sums of grips / loads over 2 μ",
    "slips in the air",
    "median time to more force (ms)",
    "95th percentile (ms)",
];

/// Content of the page.
#[derive(Debug, Clone, PartialEq)]
pub struct GripsPage {
    /// Name of the experiment.
    pub name: String,
    /// Number of objects, and the random seed.
    pub trials: u64,
    /// Random seed.
    pub seed: u64,
    /// Name of each law, and its values in the order of [`GRIP_COLUMNS`].
    pub laws: Vec<(String, [String; 9])>,
    /// A sentence for each law but the first, which compares it with the first.
    pub verdicts: Vec<String>,
    /// Mean grip against the load.
    pub grips: Curves,
}

/// Renders the page as HTML.
pub fn grips_page(page: &GripsPage) -> String {
    let drawn = [curves_figure(&page.grips, 1)];
    let title = format!("Grip laws: {}", page.name);
    let rows = page.laws.iter().map(|(law, values)| {
        html! { td { (law) } (numbers(values)) }
    });
    let body = html! {
        h1 { (title) }
        p {
            (page.trials) " random objects per law (seed " (page.seed) "): each is taken, lifted, shaken, tugged at, filled and put
            down. Laws are compared on the same objects. Ranges are 95 % intervals."
        }
        (table(html! { th { "Law" } (number_heads(GRIP_COLUMNS)) }, rows))
        @for verdict in &page.verdicts { p { (verdict) } }
        p.note {
            "Dropped: the object was not lifted, slid by more than 15 mm in the grip, or left it in the air. Crushed: a finger pressed
            harder than this object bears. Least that held (with --least-grip): the least mean grip with which the law
            “known-friction”, which knows the kinetic friction, held the same object, over six margins. Load over 2 μ: the load across the
            grip divided by twice the static friction; torsion and kinetic friction count as excess. Slips in the air: all elements
            of a finger slipped within 10 ms; the time counts until the fingers have closed far enough to press 1 % harder."
        }
        (figures(&drawn))
    };
    document_of_figures(&title, body, &drawn)
}
