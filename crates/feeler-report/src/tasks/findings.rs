//! Parts of reports that consist mostly of the task's findings.

use crate::measures::summary::Summary;
use crate::pages::text::{significant, value};
use feeler_record::TaskOutcome;
use maud::{Markup, html};

/// One-sentence summary of the run.
pub fn verdict(summary: &Summary) -> Markup {
    let outcome = summary.outcome.as_ref().map(TaskOutcome::as_str);
    html! {
        "The task ended after " (significant(summary.sim_time)) " s. Outcome: "
        (outcome.unwrap_or("undetermined")) "."
    }
}

/// Table of the task's findings.
pub fn table(summary: &Summary) -> Markup {
    html! {
        h2 { "Findings" }
        table {
            tbody {
                @for (name, found) in &summary.findings {
                    tr { th scope="row" { code { (name) } } td.number { (value(*found)) } }
                }
            }
        }
    }
}
