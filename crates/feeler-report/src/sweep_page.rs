//! `summary.html`: what came of a sweep, on one self-contained page.

use super::document::document;
use super::figures::sweep::{distributions_figure, success_figure, wilson};
use maud::{PreEscaped, html};

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
    let figures = page.numbers.len() as u32;
    let body = html! {
        h1 { "Sweep: " (page.name) }
        p.verdict {
            (trials) " trials, of which " (rate(successes, trials)) " were a success: "
            (page.success) "."
        }
        p { code { (page.varied) } }
        h2 { "How trials ended" }
        (counts_table("Outcome", &page.outcomes.iter().map(|(name, n)| (name.clone(), trials, *n)).collect::<Vec<_>>()))
        @if !page.claims.is_empty() {
            h2 { "Claims" }
            (counts_table("Claim holds", &page.claims))
        }
        h2 { "Success against what varied" }
        div.figures {
            @for (index, varied) in page.numbers.iter().enumerate() {
                figure { (PreEscaped(success_figure(varied, index as u32 + 1))) }
            }
        }
        @for (name, values) in &page.words { (counts_table(name, values)) }
        h2 { "Distribution of measures" }
        div.figures {
            figure {
                (PreEscaped(distributions_figure(&page.measures, figures + 1)))
                figcaption { "Of all trials that define the measure; the digit before it is the stroke." }
            }
        }
        h2 { "The worst trials" }
        p { "One alone, with its recording and report: " code { "feeler run --trial SWEEP_FOLDER TRIAL" } "." }
        (worst_table(page))
        details {
            summary { "The experiment, but for what varied" }
            pre { (page.experiment) }
        }
    };
    document(&format!("Sweep: {}", page.name), body)
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
