//! `NAME.html` of `feeler tune`: tuned settings, predicted success, and what costs most of it.

use super::document::{Tile, document, tiles};
use super::figures::sweep::wilson;
use super::page_data::PageData;
use super::robustness_page::percent;
use super::text::significant;
use maud::{Markup, html};

/// Content of the page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TunePage {
    /// The experiment's name.
    pub name: String,
    /// Seed of all that was drawn.
    pub seed: u64,
    /// Simulated runs of the search; 0 without one.
    pub runs: u64,
    /// Whether the search's settings were taken, and not those of the rules.
    pub by_search: bool,
    /// Number of draws of the predictions; 0 without any.
    pub draws: u64,
    /// Draws in which all claims hold: with the experiment's own settings, by the rules, as tuned.
    pub successes: [u64; 3],
    /// The tuned settings.
    pub settings: Vec<SettingRow>,
    /// The claims.
    pub claims: Vec<ClaimRow>,
    /// The uncertain values, the most costly first.
    pub costs: Vec<CostRow>,
}

/// A tuned setting.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingRow {
    /// Key in the experiment file.
    pub key: String,
    /// Unit.
    pub unit: String,
    /// Value before.
    pub before: f64,
    /// Tuned value.
    pub after: f64,
    /// The rule.
    pub reason: String,
}

/// A claim before and after tuning.
#[derive(Debug, Clone, PartialEq)]
pub struct ClaimRow {
    /// Its name.
    pub name: String,
    /// Number of draws in which it holds.
    pub held: [u64; 2],
    /// Median of its margin.
    pub median: [Option<f64>; 2],
    /// The margin that 5 % of the draws are below.
    pub low: [Option<f64>; 2],
}

/// An uncertain value.
#[derive(Debug, Clone, PartialEq)]
pub struct CostRow {
    /// Its name.
    pub name: String,
    /// Share of success, 0 to 1, in the lowest, middle and highest third of its values.
    pub thirds: [f64; 3],
}

impl CostRow {
    /// Largest difference of success between two thirds.
    pub fn spread(&self) -> f64 {
        let most = self.thirds.iter().copied().fold(0.0, f64::max);
        most - self.thirds.iter().copied().fold(1.0, f64::min)
    }
}

impl TunePage {
    /// The predicted share of success as tuned, between the ends of Wilson's 95 % interval; `None` without predictions.
    pub fn predicted(&self) -> Option<[f64; 3]> {
        (self.draws > 0).then(|| share(self.successes[2], self.draws))
    }
}

fn share(successes: u64, draws: u64) -> [f64; 3] {
    let (low, high) = wilson(successes, draws);
    [low, successes as f64 / draws.max(1) as f64, high]
}

/// The page, as HTML text.
pub fn tune_page(page: &TunePage) -> String {
    let title = format!("Tuned: {}", page.name);
    let body = html! {
        h1 { (title) }
        @if let Some(predicted) = page.predicted() {
            p.verdict { "All claims about the hand are predicted to hold in " (percent(predicted)) " of runs." }
            (tiles(&tiles_of(page)))
            p {
                (page.draws) " simulated hands (seed " (page.seed) "): identified values uniform within their 95 % intervals, all other \
                values of the apparatus within plausible ranges. No search has used these draws."
            }
        } @else {
            p.verdict { "Tuned by rules; without " code { "[sim]" } " or after Ctrl-C nothing is predicted." }
        }
        h2 { "Settings" }
        (settings_table(page))
        @if page.draws > 0 {
            h2 { "Claims before and after" }
            (claims_table(page))
            p.note { "A margin is the distance from the bound relative to the bound; a claim holds where it is not negative." }
            h2 { "Which uncertainty costs most" }
            (costs_table(page))
            p.note {
                "Share of success in the lowest, middle and highest third of each uncertain value, largest difference first. Differences below "
                (significant(100.0 * chance(page.draws))) " % are chance."
            }
        }
    };
    document(&title, body, &PageData::of_figures(&title, &[]))
}

/// Difference of the shares of two thirds of `draws` that chance alone exceeds in 5 % of cases at most.
fn chance(draws: u64) -> f64 {
    let third = (draws as f64 / 3.0).max(1.0);
    1.96 * (0.5 / third).sqrt()
}

fn tiles_of(page: &TunePage) -> Vec<Tile> {
    let labels = ["before", "by rules", "as tuned"];
    let of = |(successes, label): (&u64, &str)| {
        let [_, share, _] = share(*successes, page.draws);
        Tile::new(
            significant(100.0 * share),
            "%",
            format!("predicted success, {label}"),
        )
    };
    let mut tiles: Vec<_> = page.successes.iter().zip(labels).map(of).collect();
    tiles.push(Tile::new(page.runs.to_string(), "", "runs of the search"));
    tiles
}

fn settings_table(page: &TunePage) -> Markup {
    let how = if page.by_search {
        "Search about the rule"
    } else {
        "Rule"
    };
    html! {
        div.scroll {
            table {
                thead { tr { th { "Key" } th.number { "Before" } th.number { "Tuned" } th { "Unit" } th { (how) } } }
                tbody {
                    @for row in &page.settings {
                        tr {
                            td { code { (row.key) } }
                            td.number { (significant(row.before)) }
                            td.number { (significant(row.after)) }
                            td { (row.unit) }
                            td { (row.reason) }
                        }
                    }
                }
            }
        }
    }
}

fn claims_table(page: &TunePage) -> Markup {
    let margin = |margin: Option<f64>| margin.map_or_else(String::new, |m| format!("{m:+.2}"));
    html! {
        div.scroll {
            table {
                thead {
                    tr {
                        th { "Claim" } th.number { "Holds before" } th.number { "as tuned" }
                        th.number { "Median margin before" } th.number { "as tuned" }
                        th.number { "5 % are below, before" } th.number { "as tuned" }
                    }
                }
                tbody {
                    @for row in &page.claims {
                        tr {
                            td { (row.name) }
                            @for held in row.held { td.number { (percent(share(held, page.draws))) } }
                            @for median in row.median { td.number { (margin(median)) } }
                            @for low in row.low { td.number { (margin(low)) } }
                        }
                    }
                }
            }
        }
    }
}

fn costs_table(page: &TunePage) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr { th { "Uncertain value" } th.number { "Lowest third" } th.number { "Middle" } th.number { "Highest" } } }
                tbody {
                    @for row in &page.costs {
                        tr { td { (row.name) } @for third in row.thirds { td.number { (format!("{:.0} %", 100.0 * third)) } } }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_shows_shares_settings_and_costs() {
        let page = TunePage {
            name: "mine".to_string(),
            draws: 100,
            successes: [5, 30, 60],
            settings: vec![SettingRow {
                key: "control.over_force".to_string(),
                unit: "N".to_string(),
                before: 0.505,
                after: 0.7,
                reason: "rated".to_string(),
            }],
            costs: vec![CostRow {
                name: "pivot y".to_string(),
                thirds: [0.3, 0.6, 0.9],
            }],
            ..TunePage::default()
        };
        let text = tune_page(&page);
        for word in ["60.0 [", "control.over_force", "pivot y", "30 %"] {
            assert!(text.contains(word), "{word}");
        }
        let none = TunePage::default();
        assert!(none.predicted().is_none() && tune_page(&none).contains("nothing is predicted"));
    }
}
