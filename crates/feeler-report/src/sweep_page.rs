//! `summary.html`: what came of a sweep, on one self-contained page.

use super::document::{Tile, document, tiles};
use super::figures::Figure;
use super::figures::sweep::{distributions_figure, success_figure, wilson};
use super::page_data::PageData;
use super::series::percentile;
use super::text::{name_and_unit, significant};
use maud::html;

/// A varied number, trial by trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Varied {
    /// What it is called.
    pub name: String,
    /// Whether its logarithm was drawn.
    pub logarithmic: bool,
    /// Its value in each trial, and whether that was a success.
    pub trials: Vec<(f64, bool)>,
}

/// Trials of one value of something that is no number: value, trials, successes.
pub type Counted = (String, u64, u64);

/// A measure, trial by trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// What it is called, with its unit.
    pub name: String,
    /// Its values, where it is defined.
    pub values: Vec<f64>,
}

/// What a trial is drawn by, besides what varied.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialMeasure {
    /// What it is called, with its unit.
    pub name: String,
    /// Its value in each trial, by the trial's number, in the order of [`Varied::trials`].
    pub trials: Vec<(u64, Option<f64>)>,
}

/// What the page shows.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPage {
    /// The experiment's name.
    pub name: String,
    /// What a success is, as a sentence goes on.
    pub success: &'static str,
    /// Trials, and successes among them.
    pub counts: (u64, u64),
    /// How many trials ended how.
    pub outcomes: Vec<(String, u64)>,
    /// How many trials each claim held in.
    pub claims: Vec<Counted>,
    /// Varied numbers.
    pub numbers: Vec<Varied>,
    /// Varied words: name, and each value's trials.
    pub words: Vec<(String, Vec<Counted>)>,
    /// What tells most of a single trial, if anything is measured.
    pub measured: Option<TrialMeasure>,
    /// Main measures.
    pub measures: Vec<Measured>,
    /// The worst trials, under these names.
    pub worst_header: Vec<String>,
    /// A row each.
    pub worst: Vec<Vec<String>>,
    /// Seed and expressions, as on the command line.
    pub varied: String,
    /// The experiment, but for what varied.
    pub experiment: String,
}

/// The page, as HTML text.
pub fn sweep_page(page: &SweepPage) -> String {
    let (trials, successes) = page.counts;
    let figures = figures_of(page);
    let body = html! {
        h1 { "Sweep: " (page.name) }
        p.verdict {
            (trials) " trials, of which " (rate(successes, trials)) " were a success: "
            (page.success) "."
        }
        (tiles(&tiles_of(page)))
        p { code { (page.varied) } }
        @if !figures.is_empty() {
            h2 { "Figures" }
            div.figures { @for figure in &figures { (figure.markup()) } }
        }
        h2 { "How trials ended" }
        (counts_table("Outcome", &page.outcomes.iter().map(|(name, n)| (name.clone(), trials, *n)).collect::<Vec<_>>()))
        @if !page.claims.is_empty() {
            h2 { "Claims" }
            (counts_table("Claim holds", &page.claims))
        }
        @if !page.words.is_empty() { h2 { "Success against words that varied" } }
        @for (name, values) in &page.words { (counts_table(name, values)) }
        h2 { "The worst trials" }
        p { "One alone, with its recording and report: " code { "feeler run --trial SWEEP_FOLDER TRIAL" } "." }
        (worst_table(page))
        details {
            summary { "The experiment, but for what varied" }
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

/// What came of it, as far as it was measured.
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

/// A share with its 95 % confidence interval.
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
