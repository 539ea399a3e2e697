//! `NAME.html` of `feeler tune`: tuned settings, predicted success rate, and the uncertain values that affect it most.

use super::document::{Tile, document_of_figures, number_heads, numbers, table, tiles};
use super::text::{percent, significant};
use crate::figures::sweep::wilson;
use maud::{Markup, html};

/// Content of the tuning page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TunePage {
    /// Name of the experiment.
    pub name: String,
    /// Seed of all random draws.
    pub seed: u64,
    /// Number of simulated runs of the search; 0 without a search.
    pub runs: u64,
    /// `true` if the settings of the search were adopted instead of those of the rules.
    pub by_search: bool,
    /// Number of draws for the predictions; 0 without predictions.
    pub draws: u64,
    /// Number of draws in which all claims pass: with the original settings, with those of the rules, and as tuned.
    pub successes: [u64; 3],
    /// Tuned settings.
    pub settings: Vec<SettingRow>,
    /// Claims before and after tuning.
    pub claims: Vec<ClaimRow>,
    /// Uncertain values, by decreasing effect on the success rate.
    pub costs: Vec<CostRow>,
}

/// A tuned setting.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingRow {
    /// Key in the experiment file.
    pub key: String,
    /// Unit of both values.
    pub unit: String,
    /// Value before.
    pub before: f64,
    /// Tuned value.
    pub after: f64,
    /// Rule that determines the value.
    pub reason: String,
}

/// A claim before and after tuning.
#[derive(Debug, Clone, PartialEq)]
pub struct ClaimRow {
    /// Name of the claim.
    pub name: String,
    /// Number of draws in which the claim passes, before and after tuning.
    pub held: [u64; 2],
    /// Median of the margin, before and after tuning.
    pub median: [Option<f64>; 2],
    /// 5th percentile of the margin, before and after tuning.
    pub low: [Option<f64>; 2],
}

/// Row of the table of uncertain values: one value, and its effect on the success rate.
#[derive(Debug, Clone, PartialEq)]
pub struct CostRow {
    /// Name of the value.
    pub name: String,
    /// Success rate (0 to 1) in the lowest, middle and highest third of its values.
    pub thirds: [f64; 3],
}

impl CostRow {
    /// Largest difference in success rate between two thirds.
    pub fn spread(&self) -> f64 {
        let most = self.thirds.iter().copied().fold(0.0, f64::max);
        most - self.thirds.iter().copied().fold(1.0, f64::min)
    }
}

impl TunePage {
    /// Predicted success rate as tuned, with Wilson's 95 % interval (`[low, rate, high]`); `None` without predictions.
    pub fn predicted(&self) -> Option<[f64; 3]> {
        (self.draws > 0).then(|| share(self.successes[2], self.draws))
    }
}

fn share(successes: u64, draws: u64) -> [f64; 3] {
    let (low, high) = wilson(successes, draws);
    [low, successes as f64 / draws.max(1) as f64, high]
}

/// Renders the page as HTML.
pub fn tune_page(page: &TunePage) -> String {
    let title = format!("Tuning: {}", page.name);
    let body = html! {
        h1 { (title) }
        @if let Some(predicted) = page.predicted() {
            p.verdict { "All claims about the hand are predicted to pass in " (percent(predicted)) " of runs." }
            (tiles(&tiles_of(page)))
            p {
                (page.draws) " simulated hands (seed " (page.seed) "): identified values are uniform within their 95 % intervals, all other \
                values of the apparatus are within plausible ranges. The search did not use these draws."
            }
        } @else {
            p.verdict { "Tuned by rules; without " code { "[sim]" } " or after Ctrl-C, success is not predicted." }
        }
        h2 { "Settings" }
        (settings_table(page))
        @if page.draws > 0 {
            h2 { "Claims before and after" }
            (claims_table(page))
            p.note { "The margin is the distance from the bound relative to the bound; a claim passes if its margin is not negative." }
            h2 { "Most costly uncertainties" }
            (costs_table(page))
            p.note {
                "Success rate in the lowest, middle and highest third of each uncertain value, largest difference first. Differences below "
                (significant(100.0 * chance(page.draws))) " % are not significant."
            }
        }
    };
    document_of_figures(&title, body, &[])
}

/// Difference between the success rates of two thirds of `draws` that chance exceeds in at most 5 % of cases.
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
    let head =
        html! { th { "Key" } (number_heads(["Before", "Tuned"])) th { "Unit" } th { (how) } };
    let rows = page.settings.iter().map(|row| {
        html! {
            td { code { (row.key) } }
            (numbers([row.before, row.after].map(significant)))
            td { (row.unit) }
            td { (row.reason) }
        }
    });
    table(head, rows)
}

fn claims_table(page: &TunePage) -> Markup {
    let margin = |margin: Option<f64>| margin.map_or_else(String::new, |m| format!("{m:+.2}"));
    const COLUMNS: [&str; 6] = [
        "Passes before",
        "as tuned",
        "Median margin before",
        "as tuned",
        "5th percentile before",
        "as tuned",
    ];
    let rows = page.claims.iter().map(|row| {
        html! {
            td { (row.name) }
            (numbers(row.held.map(|held| percent(share(held, page.draws)))))
            (numbers(row.median.map(margin)))
            (numbers(row.low.map(margin)))
        }
    });
    table(html! { th { "Claim" } (number_heads(COLUMNS)) }, rows)
}

fn costs_table(page: &TunePage) -> Markup {
    let head = number_heads(["Lowest third", "Middle", "Highest"]);
    let rows = page.costs.iter().map(|row| {
        let thirds = row.thirds.map(|third| format!("{:.0} %", 100.0 * third));
        html! { td { (row.name) } (numbers(thirds)) }
    });
    table(html! { th { "Uncertain value" } (head) }, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn page_shows_rates_settings_and_costs() {
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
        assert!(
            none.predicted().is_none() && tune_page(&none).contains("success is not predicted")
        );
    }
}
