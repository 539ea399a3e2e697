//! What tasks have in common whose report is mostly what they found out.

use crate::summary::Summary;
use crate::text::{significant, value};
use feeler_record::TaskOutcome;
use maud::{Markup, html};

/// How the run ended, in a sentence.
pub fn verdict(summary: &Summary) -> Markup {
    let outcome = summary.outcome.as_ref().map(TaskOutcome::as_str);
    html! {
        "After " (significant(summary.sim_time)) " s the task ended with: "
        (outcome.unwrap_or("nothing that it could tell")) "."
    }
}

/// What the task found out, by name.
pub fn table(summary: &Summary) -> Markup {
    html! {
        h2 { "What the task found out" }
        table {
            tbody {
                @for (name, found) in &summary.findings {
                    tr { th scope="row" { code { (name) } } td.number { (value(*found)) } }
                }
            }
        }
    }
}
