//! Parts that all task reports have in common.

use crate::figures::Figure;
use crate::measures::claim::Claim;
use crate::measures::strokes::StrokeMeasures;
use crate::measures::summary::Summary;
use crate::pages::text::{significant, value};
use crate::run::data::RunData;
use crate::run::file_names::SUMMARY;
use feeler_record::{Recording, TaskOutcome};
use maud::{Markup, html};

/// Task-specific part of a report.
pub trait TaskReport: Sync {
    /// Phrase that follows the word "claims" and names their origin, such as "of this task".
    fn whose(&self) -> &'static str {
        "of this task"
    }

    /// Claims about a run with these [`stroke_measures`](RunData::stroke_measures).
    fn claims(
        &self,
        recording: &Recording,
        data: &RunData,
        strokes: &[StrokeMeasures],
    ) -> Vec<Claim>;

    /// Figures of the task.
    fn figures(&self, recording: &Recording, data: &RunData) -> Vec<Figure>;

    /// One-sentence summary of the run.
    fn verdict(&self, _: &Recording, summary: &Summary) -> Markup {
        let outcome = summary.outcome.as_ref().map(TaskOutcome::as_str);
        html! {
            "The task ended after " (significant(summary.sim_time)) " s. Outcome: "
            (outcome.unwrap_or("undetermined")) "."
        }
    }

    /// Sections with the measures of the run; by default a table of the task's findings.
    fn measured(&self, _: &Recording, summary: &Summary) -> Markup {
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
}

/// Maximum number of strokes in a table.
const MAX_SHOWN: usize = 100;

/// Strokes to show in a table (the first and the last, if there are many), and a note about the omitted ones.
pub fn shown<S>(strokes: &[S]) -> (Vec<&S>, Markup) {
    let left_out = strokes.len().saturating_sub(MAX_SHOWN);
    let shown = if left_out > 0 {
        MAX_SHOWN / 2
    } else {
        strokes.len()
    };
    let (first, rest) = strokes.split_at(shown);
    let last = &rest[rest.len().saturating_sub(MAX_SHOWN / 2)..];
    let note = html! {
        @if left_out > 0 {
            p.note {
                (left_out) " strokes in the middle are omitted here; " code { (SUMMARY) } " contains all of them."
            }
        }
    };
    (first.iter().chain(last).collect(), note)
}
