//! `robustness.html`: fraction of plausible hands on which each claim passes, and the parameters that decide it.

use super::document::{
    Tile, document_of_figures, figures, folded, incomplete, numbers, table, tiles,
};
use super::ranges_table::{RangeRow, ranges_table};
use super::text::{percent, significant};
use crate::figures::Figure;
use crate::figures::robustness::{
    Measure, NOTHING, Share, indices_figure, shares_figure, traces_figure,
};
use crate::measures::claim::DecidedBy;
use maud::{Markup, html};
use serde::Serialize;

/// Name of the measure that combines all claims decided by the hand.
pub const ALL_OF_HAND: &str = "all about the hand";

/// Content of the robustness page, serialized as `robustness.json`.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RobustnessPage {
    /// Name of the experiment.
    pub name: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// Number of completed trials of all kinds.
    pub finished: u64,
    /// Number of planned trials of all kinds.
    pub planned: u64,
    /// Number of design points at which everything varies.
    pub rows: u64,
    /// Number of hands: design points with a valid experiment.
    pub hands: u64,
    /// Number of pairs of design points from which the sensitivity indices are estimated.
    pub pairs: u64,
    /// Factors of the indices: each parameter, the run's seed, each group.
    pub factors: Vec<String>,
    /// Number of factors that are parameters; these come first.
    pub parameters: usize,
    /// One measure for each claim, and one for all claims together.
    pub measures: Vec<Measure>,
    /// Outcomes of the trials in which everything varies.
    pub endings: Vec<Ending>,
    /// Varied parameters.
    pub ranges: Vec<RangeRow>,
    /// The experiment without varied values (TOML).
    #[serde(skip)]
    pub experiment: String,
}

/// Trials with the same outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ending {
    /// Outcome of these trials, as in the table of trials.
    pub outcome: String,
    /// Number of trials.
    pub trials: u64,
    /// Reason for the outcome, as worded in one of the trials.
    pub reason: String,
}

impl RobustnessPage {
    /// Measure with this name.
    fn measure(&self, name: &str) -> Option<&Measure> {
        self.measures.iter().find(|measure| measure.name == name)
    }

    /// Fraction of hands that pass all claims, as a sentence.
    pub fn verdict(&self) -> Option<String> {
        let all = self.measures.last()?;
        let share = all.shares.first()?;
        let mut text = format!(
            "{}: {} of plausible hands pass",
            all.name,
            percent(share.share)
        );
        if let Some(share) = self.measure(ALL_OF_HAND).and_then(|m| m.shares.first()) {
            text += &format!("; {ALL_OF_HAND}: {}", percent(share.share));
        }
        let nothing = all.shares.last().filter(|share| share.of == NOTHING);
        if let Some(nominal) = nothing {
            text += &format!("; with only the seed varied: {}", percent(nominal.share));
        }
        Some(text)
    }
}

/// Renders the page as HTML.
pub fn robustness_page(page: &RobustnessPage) -> String {
    let shares = [shares_figure(&page.measures, 1)];
    let indices = match page.pairs > 0 {
        true => indices_of(page),
        false => Vec::new(),
    };
    let traced = page.measures.iter().filter(|m| !m.traces.is_empty());
    let numbered = traced.zip(2 + indices.len() as u32..);
    let traces: Vec<_> = numbered
        .map(|(m, number)| traces_figure(m, number))
        .collect();
    let body = html! {
        (incomplete(page.finished, page.planned, "completed"))
        h1 { "Robustness to unknown parameters: " (page.name) }
        @if let Some(verdict) = page.verdict() { p.verdict { (verdict) "." } }
        (tiles(&tiles_of(page)))
        p {
            (page.ranges.len()) " unknown values were varied over plausible ranges, at " (page.rows)
            " points of a scrambled Sobol' sequence (seed " (page.seed) "), each with a separate seed for quantities that differ between runs. "
            (page.hands) " points are valid hands; at " (page.rows - page.hands)
            " the experiment is invalid, and they are excluded from all fractions. Hands that stop or fail are included in all fractions."
        }
        h2 { "Fraction of plausible hands that pass each claim" }
        (figures(&shares))
        (shares_table(page))
        p.note { "Brackets show Wilson's 95 % interval. If a group is varied alone, all other values are nominal." }
        @if page.pairs > 0 { (decided(page, &indices, &traces)) }
        h2 { "Outcomes" }
        (endings_table(page))
        h2 { "Varied parameters and their ranges" }
        (ranges_table(&page.ranges))
        h2 { "Repeating a trial" }
        p { "To repeat a trial with its recording and report: " code { "feeler run --trial FOLDER TRIAL" }
            ". The trials are listed in " code { "trials.csv" } ", all values of this page in " code { "robustness.json" } "." }
        (folded("Experiment, without varied values", &page.experiment))
    };
    let title = format!("Robustness: {}", page.name);
    document_of_figures(&title, body, &[&shares[..], &indices, &traces].concat())
}

/// Key figures of the study.
fn tiles_of(page: &RobustnessPage) -> Vec<Tile> {
    let percent = |share: Option<&Share>, label| {
        share.map(|share| Tile::new(significant(100.0 * share.share[1]), "%", label))
    };
    let count = |count: u64, label| Some(Tile::new(count.to_string(), "", label));
    let all = page.measures.last().map_or(&[][..], |all| &all.shares);
    let hand = page.measure(ALL_OF_HAND).and_then(|m| m.shares.first());
    let nominal = all.iter().rfind(|share| share.of == NOTHING);
    let tiles = [
        percent(all.first(), "of plausible hands pass all claims"),
        percent(hand, "pass all claims about the hand"),
        percent(nominal, "with only the seed varied"),
        count(page.hands, "hands"),
        count(page.ranges.len() as u64, "values varied"),
    ];
    tiles.into_iter().flatten().collect()
}

/// Heat maps of the sensitivity of results and margins.
fn indices_of(page: &RobustnessPage) -> Vec<Figure> {
    const HOLDS: (&str, &str) = (
        "result",
        "Total-effect index (%): how often changing this parameter alone changes the result of the claim, \
        relative to how often changing the whole hand does.",
    );
    const MARGIN: (&str, &str) = (
        "margin",
        "Total-effect index (%) of the distance from the bound, relative to the bound and clipped to -1 to 1; unmeasured claims count as -1.",
    );
    let factors = (&page.factors[..], page.parameters);
    vec![
        indices_figure(&page.measures, factors, HOLDS, |m| &m.holds, 2),
        indices_figure(&page.measures, factors, MARGIN, |m| &m.margin, 3),
    ]
}

/// Section on sensitivity: heat maps, and claims against the most influential parameters.
fn decided(page: &RobustnessPage, indices: &[Figure], traces: &[Figure]) -> Markup {
    html! {
        h2 { "Influence of parameters" }
        (figures(indices))
        p.note {
            "Jansen's estimator over " (page.pairs) " pairs of points. First-order indices (Saltelli 2010) and the 95 % intervals of all indices (bootstrap over pairs) are in "
            code { "robustness.json" } ". Pale values are not significantly different from 0. Total effects count interactions once for each parameter involved, so their sum may exceed 100 %."
        }
        h2 { "Claims against the most influential parameters" }
        (figures(traces))
    }
}

fn shares_table(page: &RobustnessPage) -> Markup {
    let of = page.measures.first().map_or(&[][..], |m| &m.shares);
    let head = html! {
        th { "passes in (%)" } th { "decided by" }
        @for share in of { th.number { (share.of) " (" (share.hands) ")" } }
    };
    let rows = page.measures.iter().map(|measure| {
        html! {
            td { (measure.name) }
            td { (measure.decided_by.map_or("", decided_by)) }
            (numbers(measure.shares.iter().map(|share| percent(share.share))))
        }
    });
    table(head, rows)
}

/// Table text for the part of the apparatus that decides a claim.
pub fn decided_by(decided_by: DecidedBy) -> &'static str {
    match decided_by {
        DecidedBy::Hand => "hand",
        DecidedBy::HandAndBottle => "hand and bottle",
    }
}

fn endings_table(page: &RobustnessPage) -> Markup {
    let head = html! { th { "Outcome" } th.number { "Points" } th { "Example reason" } };
    let rows = page.endings.iter().map(|ending| {
        html! {
            td { (ending.outcome) @if ending.outcome == "invalid" { " (not a valid hand)" } }
            td.number { (ending.trials) }
            td { (ending.reason) }
        }
    });
    table(head, rows)
}
