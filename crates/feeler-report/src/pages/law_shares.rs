//! `laws.html`: fraction of the same hands on which each control law meets the claims of any hand.

use super::document::{Tile, document, tiles};
use super::ranges_table::{RangeRow, ranges_table};
use super::robustness::{Share, percent};
use super::text::significant;
use crate::figures::law_shares::law_shares_figure;
use crate::page_data::PageData;
use maud::{Markup, html};
use serde::Serialize;

/// Content of the page that compares control laws on the same hands, serialized as `laws.json`.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct LawSharesPage {
    /// Name of the experiment.
    pub name: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// Number of trials per law.
    pub planned: u64,
    /// Number of trials completed under all laws.
    pub finished: u64,
    /// Number of hands among them: points at which the experiment is valid under at least one law.
    pub hands: u64,
    /// Results of the laws, in the order of the command line.
    pub laws: Vec<LawShares>,
    /// Varied parameters.
    pub ranges: Vec<RangeRow>,
    /// The experiment without law and varied values (TOML).
    #[serde(skip)]
    pub experiment: String,
}

/// Results of one law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LawShares {
    /// Name of the law.
    pub law: String,
    /// Number of hands that are invalid under this law only. They count as hands on which no claim passes.
    pub refused: u64,
    /// Fraction of hands for each claim of any hand, and for all claims with the task completed.
    pub shares: Vec<Share>,
}

/// Renders the page as HTML.
pub fn law_shares_page(page: &LawSharesPage) -> String {
    let figure = law_shares_figure(page, 1);
    let title = format!("Control laws on the same hands: {}", page.name);
    let body = html! {
        @if page.finished < page.planned {
            div.incomplete role="alert" {
                "INCOMPLETE: " (page.finished) " of " (page.planned) " trials are completed under every law."
            }
        }
        h1 { (title) }
        (tiles(&tiles_of(page)))
        p {
            (page.ranges.len()) " unknown values were varied over plausible ranges, at " (page.finished)
            " points of a scrambled Sobol' sequence (seed " (page.seed) "). " (page.hands)
            " of them are valid hands; each ran under every law, with the same seed."
        }
        h2 { "Fraction of hands" }
        div.figures { (figure.markup()) }
        (shares_table(page))
        p.note {
            "Brackets show Wilson's 95 % interval. The claims are those of any hand; all five count only if the task was completed."
        }
        (refusals(page))
        h2 { "Varied parameters and their ranges" }
        (ranges_table(&page.ranges))
        h2 { "Repeating a trial" }
        p { "To repeat a trial with its recording and report: " code { "feeler run --trial FOLDER/LAW TRIAL" }
            ". The trials are listed in " code { "trials.csv" } " of each law's folder, the values of this page in " code { "laws.json" } "." }
        details {
            summary { "Experiment, without law and varied values" }
            pre { (page.experiment) }
        }
    };
    document(&title, body, &PageData::of_figures(&title, &[figure]))
}

/// Key figures: fraction of hands on which all claims pass, for each law.
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

/// Notes on laws that reject hands which are valid under others.
fn refusals(page: &LawSharesPage) -> Markup {
    html! {
        @for law in page.laws.iter().filter(|law| law.refused > 0) {
            p.note {
                (law.law) " rejects " (law.refused) " of the hands. They count as hands on which no claim passes; "
                code { "trials.csv" } " lists the reasons."
            }
        }
    }
}
