//! `league.html`: detectors and calibrations compared on published data sets, on a self-contained page.

use super::document::{document_of_figures, facts_table, number_heads, numbers, table};
use super::text::{number, percent, with_interval};
use maud::{Markup, html};
use serde::Serialize;

/// Content of the league page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LeaguePage {
    /// Version of feeler.
    pub version: String,
    /// Name and command of each program of the user.
    pub programs: Vec<(String, String)>,
    /// The data sets.
    pub sets: Vec<LeagueSet>,
    /// Names of data sets that were not found.
    pub missing: Vec<String>,
}

impl LeaguePage {
    /// Returns `true` if a data set could not be read, or a program failed.
    pub fn has_failed(&self) -> bool {
        let failed = |set: &LeagueSet| set.failed.is_some() || set.rows.iter().any(|r| r.is_error);
        self.sets.iter().any(failed)
    }
}

/// A data set and the results on it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct LeagueSet {
    /// Name of the data set.
    pub name: String,
    /// Description of the data set.
    pub title: String,
    /// Origin of the data.
    pub source: String,
    /// Licence of the data.
    pub licence: String,
    /// Numbers of recordings, groups and rows.
    pub content: String,
    /// Description of the split into training and test data.
    pub split: String,
    /// Hash of the input files.
    pub digest: String,
    /// Name and unit of each metric.
    pub metrics: Vec<(String, String)>,
    /// Results of the detectors or calibrations.
    pub rows: Vec<LeagueRow>,
    /// Published results to compare with.
    pub published: Vec<PublishedFigure>,
    /// Error message if the data set cannot be read.
    pub failed: Option<String>,
    /// Notes on irregular data.
    pub notes: Vec<String>,
}

/// Results of one detector or calibration.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct LeagueRow {
    /// Displayed name.
    pub entry: String,
    /// Name in tables.
    pub key: String,
    /// Each metric with its 95 % confidence interval: lower end, estimate, upper end. Fractions from 0 to 1.
    pub values: Vec<Option<[f64; 3]>>,
    /// Reason why there are no results.
    pub failed: Option<String>,
    /// `true` if `failed` describes an error.
    pub is_error: bool,
    /// `true` if the detector or calibration was developed on these data.
    pub chosen_here: bool,
}

/// A published result.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PublishedFigure {
    /// Metric, or the start of the names of several metrics.
    pub metric: String,
    /// Value with unit.
    pub value: String,
    /// Publication that states the value.
    pub source: String,
}

impl LeagueSet {
    /// Name of a metric with its unit.
    pub fn metric_name(&self, index: usize) -> String {
        match self.metrics.get(index) {
            Some((name, unit)) if unit.is_empty() => name.clone(),
            Some((name, unit)) => format!("{name} ({unit})"),
            None => String::new(),
        }
    }

    /// Published values of a metric.
    pub fn published_for(&self, index: usize) -> String {
        let name = self.metrics.get(index).map_or("", |(name, _)| name);
        let is_of = |published: &&PublishedFigure| {
            let rest = name.strip_prefix(published.metric.as_str());
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
        };
        let values = self
            .published
            .iter()
            .filter(is_of)
            .map(|published| published.value.as_str());
        values.collect::<Vec<_>>().join(", ")
    }

    /// Formatted value of a metric of a detector or calibration.
    pub fn shown(&self, row: &LeagueRow, index: usize) -> String {
        let Some(value) = row.values.get(index).copied().flatten() else {
            return if row.failed.is_some() { "failed" } else { "-" }.into();
        };
        match self.metrics.get(index).map_or("", |(name, _)| name) {
            "accuracy" => percent(value),
            "auc" => with_interval(value, |value| format!("{value:.3}")),
            _ if value[1].abs() < 1.0 => with_interval(value, |value| format!("{value:.3}")),
            _ => number(value),
        }
    }
}

/// Renders the page as HTML.
pub fn league_page(page: &LeaguePage) -> String {
    let body = html! {
        h1 { "Touch league" }
        p {
            "Detectors and calibrations on published recordings of tactile sensors, with the same splits for all. Written by feeler "
            (page.version) "; the same version, data and programs give the same page. Brackets show 95 % confidence intervals: bootstrap "
            "over groups, or over contiguous parts of the recordings if fewer than five groups are tested for measured values. "
            "An asterisk marks entries that were developed on these data, whose results are therefore optimistic."
        }
        @if !page.programs.is_empty() {
            h2 { "Programs" }
            (facts_table(page.programs.iter().map(|(name, command)| (name, html! { code { (command) } }))))
        }
        @for set in &page.sets { (section(set)) }
        @if !page.missing.is_empty() {
            h2 { "Not found" }
            p { (page.missing.join(", ")) }
        }
    };
    document_of_figures("Touch league", body, &[])
}

fn section(set: &LeagueSet) -> Markup {
    let facts = [
        ("Source", &set.source),
        ("Licence", &set.licence),
        ("Content", &set.content),
        ("Split", &set.split),
        ("SHA-256 of the files", &set.digest),
    ];
    let columns = (0..set.metrics.len()).map(|index| set.metric_name(index));
    let head = html! { th { "Entry" } (number_heads(columns)) };
    let rows = set.rows.iter().map(|row| {
        let values = (0..set.metrics.len()).map(|index| set.shown(row, index));
        html! { td { (row.entry) @if row.chosen_here { " *" } } (numbers(values)) }
    });
    let failed = set
        .rows
        .iter()
        .filter_map(|row| Some((&row.entry, row.failed.as_ref()?)));
    html! {
        h2 id=(set.name) { (set.name) }
        p { (set.title) }
        (facts_table(facts.into_iter().filter(|(_, fact)| !fact.is_empty())))
        @if let Some(failed) = &set.failed {
            div.incomplete role="alert" { "FAILED: " (failed) }
        } @else {
            (table(head, rows))
        }
        @if !set.published.is_empty() {
            p.note { "Published:"
                @for published in &set.published { " " (published.metric) " " (published.value) " (" (published.source) ")." }
            }
        }
        ul {
            @for (entry, failed) in failed { li { (entry) ": " (failed) } }
            @for note in &set.notes { li { (note) } }
        }
    }
}
