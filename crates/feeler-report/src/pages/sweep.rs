//! `summary.html`: results of a sweep, on a self-contained page.

use super::document::{Tile, document, tiles};
use super::text::{name_and_unit, significant};
use crate::figures::Figure;
use crate::figures::sweep::{distributions_figure, success_figure, wilson};
use crate::measures::series::percentile;
use crate::page_data::PageData;
use maud::html;

/// A varied number with its value in each trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Varied {
    /// Name of the number.
    pub name: String,
    /// `true` if it was drawn on a logarithmic scale.
    pub logarithmic: bool,
    /// Value in each trial, and whether the trial was a success.
    pub trials: Vec<(f64, bool)>,
}

/// A category with its number of trials and number of successes.
pub type Counted = (String, u64, u64);

/// A measure with its values over all trials.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Name and unit.
    pub name: String,
    /// Values of the trials that define it.
    pub values: Vec<f64>,
}

/// The measure plotted per trial against the varied numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialMeasure {
    /// Name and unit.
    pub name: String,
    /// Trial number and value of each trial, in the order of [`Varied::trials`].
    pub trials: Vec<(u64, Option<f64>)>,
}

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
    /// Varied numbers.
    pub numbers: Vec<Varied>,
    /// Varied texts: name, and trials per value.
    pub words: Vec<(String, Vec<Counted>)>,
    /// Measure that characterizes a single trial best, if any is measured.
    pub measured: Option<TrialMeasure>,
    /// Main measures.
    pub measures: Vec<Measured>,
    /// Header of the table of the worst trials.
    pub worst_header: Vec<String>,
    /// Rows of the table of the worst trials.
    pub worst: Vec<Vec<String>>,
    /// Seed and expressions, as on the command line.
    pub varied: String,
    /// The experiment without varied values.
    pub experiment: String,
}

/// Renders the page as HTML.
pub fn sweep_page(page: &SweepPage) -> String {
    let (trials, successes) = page.counts;
    let figures = figures_of(page);
    let body = html! {
        h1 { "Sweep: " (page.name) }
        p.verdict {
            (trials) " trials; " (rate(successes, trials)) " were a success: "
            (page.success) "."
        }
        (tiles(&tiles_of(page)))
        p { code { (page.varied) } }
        @if !figures.is_empty() {
            h2 { "Figures" }
            div.figures { @for figure in &figures { (figure.markup()) } }
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
        details {
            summary { "Experiment, without varied values" }
            pre { (page.experiment) }
        }
    };
    let title = format!("Sweep: {}", page.name);
    document(&title, body, &PageData::of_figures(&title, &figures))
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
    html! {
        div.scroll {
            table {
                thead { tr { th { (name) } th.number { "Of" } th.number { "Trials" } } }
                tbody {
                    @for (value, trials, count) in rows {
                        tr { td { (value) } td.number { (trials) } td.number { (rate(*count, *trials)) } }
                    }
                }
            }
        }
    }
}

fn worst_table(page: &SweepPage) -> maud::Markup {
    html! {
        @if page.worst.is_empty() { p { "None: every trial was a success." } } @else {
            div.scroll {
                table {
                    thead { tr { @for name in &page.worst_header { th { (name) } } } }
                    tbody {
                        @for row in &page.worst { tr { @for field in row { td { (field) } } } }
                    }
                }
            }
        }
    }
}
