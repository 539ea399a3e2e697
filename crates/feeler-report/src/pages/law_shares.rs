//! `laws.html`: fraction of the same hands on which each control law passes the claims about any hand.

use super::document::{
    Tile, document_of_figures, figures, folded, incomplete, number_heads, numbers, table, tiles,
};
use super::ranges_table::{RangeRow, ranges_table};
use super::text::{percent, significant};
use crate::figures::law_shares::{LawShares, law_shares_figure};
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
    /// Number of hands among the completed trials: points at which the experiment is valid under at least one law.
    pub hands: u64,
    /// Results of the laws, in the order of the command line.
    pub laws: Vec<LawShares>,
    /// Varied parameters.
    pub ranges: Vec<RangeRow>,
    /// The experiment without law and varied values (TOML).
    #[serde(skip)]
    pub experiment: String,
}

/// Renders the page as HTML.
pub fn law_shares_page(page: &LawSharesPage) -> String {
    let drawn = [law_shares_figure(&page.laws, 1)];
    let title = format!("Control laws on the same hands: {}", page.name);
    let body = html! {
        (incomplete(page.finished, page.planned, "completed under every law"))
        h1 { (title) }
        (tiles(&tiles_of(page)))
        p {
            (page.ranges.len()) " unknown values were varied over plausible ranges, at " (page.finished)
            " points of a scrambled Sobol' sequence (seed " (page.seed) "). " (page.hands)
            " of them are valid hands; each ran under every law, with the same seed."
        }
        h2 { "Fraction of hands" }
        (figures(&drawn))
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
        (folded("Experiment, without law and varied values", &page.experiment))
    };
    document_of_figures(&title, body, &drawn)
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
    let head = html! { th { "Law" } (number_heads(of.iter().map(|share| &share.of))) };
    let rows = page.laws.iter().map(|law| {
        let shares = law.shares.iter().map(|share| percent(share.share));
        html! { th scope="row" { (law.law) } (numbers(shares)) }
    });
    table(head, rows)
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
