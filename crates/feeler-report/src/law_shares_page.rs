//! `laws.html`: share of the same hands on which each control law meets the claims of any hand.

use super::document::{Tile, document, tiles};
use super::figures::law_shares::law_shares_figure;
use super::page_data::PageData;
use super::ranges_table::{RangeRow, ranges_table};
use super::robustness_page::{Share, percent};
use super::text::significant;
use maud::{Markup, html};
use serde::Serialize;

/// What the page shows; as JSON, `laws.json`.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct LawSharesPage {
    /// Name of the experiment.
    pub name: String,
    /// Seed of all that is drawn.
    pub seed: u64,
    /// Number of trials of each law.
    pub planned: u64,
    /// Number of trials that all laws have finished.
    pub finished: u64,
    /// Number of hands among them: points whose experiment is valid under any of the laws.
    pub hands: u64,
    /// The laws, in the order of the command line.
    pub laws: Vec<LawShares>,
    /// What varied.
    pub ranges: Vec<RangeRow>,
    /// The experiment, but for law and what varied (TOML).
    #[serde(skip)]
    pub experiment: String,
}

/// The shares of one law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LawShares {
    /// Name of the law.
    pub law: String,
    /// Number of hands that are invalid under this law alone. They count as hands on which nothing holds.
    pub refused: u64,
    /// Share of hands for each claim of any hand, and for all of them with the task done.
    pub shares: Vec<Share>,
}

/// The page, as HTML text.
pub fn law_shares_page(page: &LawSharesPage) -> String {
    let figure = law_shares_figure(page, 1);
    let title = format!("Laws on the same hands: {}", page.name);
    let body = html! {
        @if page.finished < page.planned {
            div.incomplete role="alert" {
                "INCOMPLETE: " (page.finished) " of " (page.planned) " trials are finished under every law."
            }
        }
        h1 { (title) }
        (tiles(&tiles_of(page)))
        p {
            (page.ranges.len()) " values that nobody knows were varied over plausible ranges, at " (page.finished)
            " points of a scrambled Sobol' sequence (seed " (page.seed) "). " (page.hands)
            " of them are hands; each ran under every law, with the same seed."
        }
        h2 { "Share of hands" }
        div.figures { (figure.markup()) }
        (shares_table(page))
        p.note {
            "In brackets Wilson's 95 % interval. The claims are those of any hand; all five count only where the task was done."
        }
        (refusals(page))
        h2 { "What was varied, and why so far" }
        (ranges_table(&page.ranges))
        h2 { "One of the hands again" }
        p { "With its recording and report: " code { "feeler run --trial FOLDER/LAW TRIAL" }
            "; the trials are in " code { "trials.csv" } " of each law's folder, the figures of this page in " code { "laws.json" } "." }
        details {
            summary { "The experiment, but for law and what varied" }
            pre { (page.experiment) }
        }
    };
    document(&title, body, &PageData::of_figures(&title, &[figure]))
}

/// The share of hands on which all claims hold, of each law.
fn tiles_of(page: &LawSharesPage) -> Vec<Tile> {
    let all = page
        .laws
        .iter()
        .filter_map(|law| Some((law, law.shares.last()?)));
    let mut tiles: Vec<_> = all
        .map(|(law, all)| {
            let label = format!("of hands: {} under {}", all.of, law.law);
            Tile::new(significant(100.0 * all.share[1]), "%", label)
        })
        .collect();
    tiles.push(Tile::new(page.hands.to_string(), "", "hands"));
    tiles
}

fn shares_table(page: &LawSharesPage) -> Markup {
    let of = page.laws.first().map_or(&[][..], |law| &law.shares);
    html! {
        div.scroll {
            table {
                thead { tr { th { "Law" } @for share in of { th.number { (share.of) } } } }
                tbody {
                    @for law in &page.laws {
                        tr { th scope="row" { (law.law) } @for share in &law.shares { td.number { (percent(share.share)) } } }
                    }
                }
            }
        }
    }
}

/// The laws that refuse hands which are valid under others.
fn refusals(page: &LawSharesPage) -> Markup {
    html! {
        @for law in page.laws.iter().filter(|law| law.refused > 0) {
            p.note {
                (law.law) " refuses " (law.refused) " of the hands. They count as hands on which nothing holds; "
                code { "trials.csv" } " has the reasons."
            }
        }
    }
}
