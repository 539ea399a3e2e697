//! `summary.html`: results of a sweep, on a self-contained page.

use super::document::{Tile, document_of_figures, figures, folded, table, tiles};
use super::text::{name_and_unit, significant};
use crate::figures::Figure;
use crate::figures::sweep::{
    Measured, TrialMeasure, Varied, distributions_figure, success_figure, wilson,
};
use crate::measures::series::percentile;
use maud::html;

/// A category with its number of trials and number of successes.
pub type Counted = (String, u64, u64);

/// Content of the sweep page.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPage {
    /// Name of the experiment.
    pub name: String,
    /// Success criterion, as the end of a sentence.
    pub success: &'static str,
    /// Number of trials, and number of successes.
    pub counts: (u64, u64),
    /// Outcomes with their number of trials.
    pub outcomes: Vec<(String, u64)>,
    /// Claims with the number of trials in which they pass.
    pub claims: Vec<Counted>,
    /// Varied numeric parameters.
    pub numbers: Vec<Varied>,
    /// Varied text parameters: name, and trials per value.
    pub words: Vec<(String, Vec<Counted>)>,
    /// Measure that characterizes a single trial best, if any is measured.
    pub measured: Option<TrialMeasure>,
    /// Main measures.
    pub measures: Vec<Measured>,
    /// Header of the table of the worst trials.
    pub worst_header: Vec<String>,
    /// Rows of the table of the worst trials.
    pub worst: Vec<Vec<String>>,
    /// Seed and `--vary` expressions, as on the command line.
    pub varied: String,
    /// The experiment without varied values.
    pub experiment: String,
}

/// Renders the page as HTML.
pub fn sweep_page(page: &SweepPage) -> String {
    let (trials, successes) = page.counts;
    let drawn = figures_of(page);
    let body = html! {
        h1 { "Sweep: " (page.name) }
        p.verdict {
            (trials) " trials; " (rate(successes, trials)) " were a success: "
            (page.success) "."
        }
        (tiles(&tiles_of(page)))
        p { code { (page.varied) } }
        @if !drawn.is_empty() {
            h2 { "Figures" }
            (figures(&drawn))
        }
        h2 { "Outcomes" }
        (counts_table("Outcome", &page.outcomes.iter().map(|(name, n)| (name.clone(), trials, *n)).collect::<Vec<_>>()))
        @if !page.claims.is_empty() {
            h2 { "Claims" }
            (counts_table("Claim passes", &page.claims))
        }
        @if !page.words.is_empty() { h2 { "Success by varied category" } }
        @for (name, values) in &page.words { (counts_table(name, values)) }
        h2 { "Worst trials" }
        p { "To repeat a trial with its recording and report: " code { "feeler run --trial SWEEP_FOLDER TRIAL" } "." }
        (worst_table(page))
        (folded("Experiment, without varied values", &page.experiment))
    };
    let title = format!("Sweep: {}", page.name);
    document_of_figures(&title, body, &drawn)
}

fn figures_of(page: &SweepPage) -> Vec<Figure> {
    let measured = page.measured.as_ref();
    let numbered = page.numbers.iter().zip(1..);
    let mut figures: Vec<_> = numbered
        .map(|(varied, number)| success_figure(varied, number, measured))
        .collect();
    if !page.measures.is_empty() {
        let number = figures.len() as u32 + 1;
        figures.push(distributions_figure(&page.measures, number));
    }
    figures
}

/// Key figures, as far as they were measured.
fn tiles_of(page: &SweepPage) -> Vec<Tile> {
    let (trials, successes) = page.counts;
    let share = 100.0 * successes as f64 / trials.max(1) as f64;
    let mut tiles = vec![
        Tile::new(significant(share), "%", "of trials were a success"),
        Tile::new(trials.to_string(), "", "trials"),
    ];
    if let Some(measured) = &page.measured {
        let known = measured.trials.iter().filter_map(|(_, value)| *value);
        let (name, unit) = name_and_unit(&measured.name);
        if let Some(median) = percentile(known, 50.0) {
            tiles.push(Tile::new(
                significant(median),
                unit,
                format!("{name}, median"),
            ));
        }
    }
    tiles
}

/// Formats a count of successes with its 95 % confidence interval.
fn rate(successes: u64, trials: u64) -> String {
    let (low, high) = wilson(successes, trials);
    let share = 100.0 * successes as f64 / trials.max(1) as f64;
    format!(
        "{successes} ({share:.1} %; 95 % confidence {:.1} to {:.1} %)",
        100.0 * low,
        100.0 * high
    )
}

fn counts_table(name: &str, rows: &[Counted]) -> maud::Markup {
    let rows = rows.iter().map(|(value, trials, count)| {
        html! { td { (value) } td.number { (trials) } td.number { (rate(*count, *trials)) } }
    });
    table(
        html! { th { (name) } th.number { "Of" } th.number { "Trials" } },
        rows,
    )
}

fn worst_table(page: &SweepPage) -> maud::Markup {
    if page.worst.is_empty() {
        return html! { p { "None: every trial was a success." } };
    }
    let head = html! { @for name in &page.worst_header { th { (name) } } };
    let rows = page.worst.iter();
    let rows = rows.map(|row| html! { @for field in row { td { (field) } } });
    table(head, rows)
}
