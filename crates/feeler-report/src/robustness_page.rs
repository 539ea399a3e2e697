//! `robustness.html`: in what share of plausible hands each claim holds, and which parameters decide it.

use super::claim::DecidedBy;
use super::document::{Tile, document, tiles};
use super::figures::Figure;
use super::figures::robustness::{indices_figure, shares_figure, traces_figure};
use super::page_data::PageData;
use super::ranges_table::{RangeRow, ranges_table};
use super::sweep_page::Varied;
use super::text::significant;
use maud::{Markup, html};
use serde::Serialize;

/// What a share is of in which nothing varies but the run's seed.
pub const NOTHING: &str = "nothing varied";
/// Name of the measure of all claims that the hand decides.
pub const ALL_OF_HAND: &str = "all about the hand";

/// What the page shows; as JSON, `robustness.json`.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RobustnessPage {
    /// The experiment's name.
    pub name: String,
    /// Seed of all that is drawn.
    pub seed: u64,
    /// Trials that are finished, of all kinds.
    pub finished: u64,
    /// Trials that were asked for, of all kinds.
    pub planned: u64,
    /// Points of the design at which everything varies.
    pub rows: u64,
    /// Hands among them: points whose experiment can be run.
    pub hands: u64,
    /// Pairs of points that the indices are of.
    pub pairs: u64,
    /// What indices are of: each parameter, the run's own seed, each group.
    pub factors: Vec<String>,
    /// How many of the factors are parameters; they come first.
    pub parameters: usize,
    /// Each claim, and all together.
    pub measures: Vec<Measure>,
    /// How the trials in which everything varies ended.
    pub endings: Vec<Ending>,
    /// What varied, and why so far.
    pub ranges: Vec<RangeRow>,
    /// The experiment, but for what varied (TOML).
    #[serde(skip)]
    pub experiment: String,
}

/// A claim, or all together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measure {
    /// What it is called.
    pub name: String,
    /// What decides it, or `None` (JSON null) for all together and for claims of other tasks.
    pub decided_by: Option<DecidedBy>,
    /// In what share it holds: with everything varied, each group alone, nothing but the seed.
    pub shares: Vec<Share>,
    /// What decides whether it holds, by factor.
    pub holds: Vec<Index>,
    /// What decides its margin, from -1 to 1, by factor; empty where it has none.
    pub margin: Vec<Index>,
    /// The parameters of greatest total effect.
    #[serde(skip)]
    pub traces: Vec<Trace>,
}

/// A share of hands.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Share {
    /// Of what hands.
    pub of: String,
    /// How many there are.
    pub hands: u64,
    /// In how many it holds.
    pub holding: u64,
    /// The share between the ends of Wilson's 95 % interval, 0 to 1.
    pub share: [f64; 3],
}

/// Indices of one factor, each between the ends of its 95 % interval; none where nothing varies.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Index {
    /// The factor.
    pub factor: String,
    /// First-order index.
    pub first: Option<[f64; 3]>,
    /// Total-effect index.
    pub total: Option<[f64; 3]>,
}

/// A parameter's values in all hands, and whether the claim holds there.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Values and results.
    pub varied: Varied,
    /// Its total-effect index.
    pub total: f64,
    /// What the experiment has.
    pub nominal: Option<f64>,
}

/// Trials that ended alike.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ending {
    /// The outcome.
    pub outcome: String,
    /// How many.
    pub trials: u64,
    /// The reason of one of them.
    pub reason: String,
}

impl Measure {
    /// The factors of greatest total effect on whether it holds, largest first, those whose interval reaches 0 left out.
    pub fn deciding(&self, parameters: usize) -> Vec<(&str, f64)> {
        let alone = self.holds.iter().take(parameters);
        let known = alone.filter_map(|index| Some((index.factor.as_str(), index.total?)));
        let clear = known.filter(|(_, total)| total[0] > 0.0);
        let mut ranked: Vec<_> = clear.map(|(factor, total)| (factor, total[1])).collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        ranked
    }
}

impl RobustnessPage {
    /// The measure of this name.
    fn measure(&self, name: &str) -> Option<&Measure> {
        self.measures.iter().find(|measure| measure.name == name)
    }

    /// The share of all together, as a sentence goes.
    pub fn verdict(&self) -> Option<String> {
        let all = self.measures.last()?;
        let share = all.shares.first()?;
        let mut text = format!(
            "{}: in {} of plausible hands",
            all.name,
            percent(share.share)
        );
        if let Some(share) = self.measure(ALL_OF_HAND).and_then(|m| m.shares.first()) {
            text += &format!(", {ALL_OF_HAND} in {}", percent(share.share));
        }
        let nothing = all.shares.last().filter(|share| share.of == NOTHING);
        if let Some(nominal) = nothing {
            text += &format!(
                "; with nothing varied but the seed, {}",
                percent(nominal.share)
            );
        }
        Some(text)
    }
}

/// The page, as HTML text.
pub fn robustness_page(page: &RobustnessPage) -> String {
    let shares = shares_figure(page, 1);
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
        @if page.finished < page.planned {
            div.incomplete role="alert" {
                "INCOMPLETE: " (page.finished) " of " (page.planned) " trials are finished."
            }
        }
        h1 { "How much is luck of parameters? " (page.name) }
        @if let Some(verdict) = page.verdict() { p.verdict { (verdict) "." } }
        (tiles(&tiles_of(page)))
        p {
            (page.ranges.len()) " values that nobody knows were varied over plausible ranges, at " (page.rows)
            " points of a scrambled Sobol' sequence (seed " (page.seed) "), each with a seed of its own for what differs from run to run. "
            (page.hands) " of them are hands; " (page.rows - page.hands)
            " are not, as the experiment is refused there, and stand in no share. A hand that stops or fails stands in every share."
        }
        h2 { "In what share of plausible hands each claim holds" }
        div.figures { (shares.markup()) }
        (shares_table(page))
        p.note { "In brackets Wilson's 95 % interval. Where a group is varied alone, all else is as the experiment has it." }
        @if page.pairs > 0 { (decided(page, &indices, &traces)) }
        h2 { "How the hands ended" }
        (endings_table(page))
        h2 { "What was varied, and why so far" }
        (ranges_table(&page.ranges))
        h2 { "One of the hands again" }
        p { "With its recording and report: " code { "feeler run --trial FOLDER TRIAL" }
            "; the trials stand in " code { "trials.csv" } ", all figures of this page in " code { "robustness.json" } "." }
        details {
            summary { "The experiment, but for what varied" }
            pre { (page.experiment) }
        }
    };
    let title = format!("Robustness: {}", page.name);
    let figures = [vec![shares], indices, traces].concat();
    document(&title, body, &PageData::of_figures(&title, &figures))
}

/// What came of it.
fn tiles_of(page: &RobustnessPage) -> Vec<Tile> {
    let share = |share: &Share| significant(100.0 * share.share[1]);
    let all = page.measures.last().map_or(&[][..], |all| &all.shares);
    let plausible = all
        .first()
        .map(|s| (share(s), "of plausible hands hold all claims"));
    let hand = page.measure(ALL_OF_HAND).and_then(|m| m.shares.first());
    let hand = hand.map(|s| (share(s), "hold all claims about the hand"));
    let nothing = all.iter().rfind(|share| share.of == NOTHING);
    let nominal = nothing.map(|s| (share(s), "with nothing varied but the seed"));
    let shares = plausible.into_iter().chain(hand).chain(nominal);
    let mut tiles: Vec<_> = shares
        .map(|(value, label)| Tile::new(value, "%", label))
        .collect();
    tiles.push(Tile::new(page.hands.to_string(), "", "hands"));
    tiles.push(Tile::new(
        page.ranges.len().to_string(),
        "",
        "values varied",
    ));
    tiles
}

/// The heat maps: what decides whether claims hold, and by what margin.
fn indices_of(page: &RobustnessPage) -> Vec<Figure> {
    const HOLDS: (&str, &str) = (
        "whether it holds",
        "Total-effect index (%): how often another value of this parameter alone changes whether the claim holds, \
        relative to how often another hand does.",
    );
    const MARGIN: (&str, &str) = (
        "its margin",
        "The same of the distance from the bound, relative to the bound and cut off at -1 and 1; what was not measured is -1.",
    );
    vec![
        indices_figure(page, HOLDS, |m| &m.holds, 2),
        indices_figure(page, MARGIN, |m| &m.margin, 3),
    ]
}

/// What decides whether claims hold: heat maps, and the claims against the parameters that matter most.
fn decided(page: &RobustnessPage, indices: &[Figure], traces: &[Figure]) -> Markup {
    html! {
        h2 { "Which parameters decide it" }
        div.figures { @for figure in indices { (figure.markup()) } }
        p.note {
            "Jansen's estimator over " (page.pairs) " pairs of points; first-order indices (Saltelli 2010) and the 95 % intervals of all (bootstrap over pairs) are in "
            code { "robustness.json" } ". Pale figures cannot be told from 0. Total effects count interactions for each parameter that takes part, so that their sum may exceed 100 %."
        }
        h2 { "Claims against the parameters that decide most" }
        div.figures { @for figure in traces { (figure.markup()) } }
    }
}

fn shares_table(page: &RobustnessPage) -> Markup {
    let of = page.measures.first().map_or(&[][..], |m| &m.shares);
    html! {
        div.scroll {
            table {
                thead { tr { th { "holds in (%)" } th { "decided by" } @for share in of { th.number { (share.of) " (" (share.hands) ")" } } } }
                tbody {
                    @for measure in &page.measures {
                        tr {
                            td { (measure.name) }
                            td { (measure.decided_by.map_or("", decided_by)) }
                            @for share in &measure.shares { td.number { (percent(share.share)) } }
                        }
                    }
                }
            }
        }
    }
}

/// What decides a claim, as a table has it.
pub fn decided_by(decided_by: DecidedBy) -> &'static str {
    match decided_by {
        DecidedBy::Hand => "hand",
        DecidedBy::HandAndBottle => "hand and bottle",
    }
}

fn endings_table(page: &RobustnessPage) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr { th { "Outcome" } th.number { "Points" } th { "Reason, of one of them" } } }
                tbody {
                    @for ending in &page.endings {
                        tr {
                            td { (ending.outcome) @if ending.outcome == "invalid" { " (no hand)" } }
                            td.number { (ending.trials) }
                            td { (ending.reason) }
                        }
                    }
                }
            }
        }
    }
}

/// A share in percent with its interval.
pub fn percent(share: [f64; 3]) -> String {
    let [low, share, high] = share.map(|part| 100.0 * part);
    format!("{share:.1} [{low:.1}, {high:.1}] %")
}
