//! Task-specific parts of reports: claims, measures and figures.

mod cap;
pub(crate) mod carry;
pub mod contour;
mod findings;
mod friction_scan;
mod screw;

use super::figures::Figure;
use crate::measures::cap::is_felt;
use crate::measures::claim::Claim;
use crate::measures::strokes::StrokeMeasures;
use crate::measures::summary::Summary;
use crate::run::data::RunData;
use crate::run::make::SUMMARY;
use feeler_record::{Recording, RunFacts, TaskKind};
use maud::{Markup, html};

/// Origin of the screw task's claims.
pub(crate) const PAPERS: &str = "of the paper";

/// Origin of the claims that apply to any hand.
const ANY_HANDS: &str = "of any hand";

/// Task-specific part of a report.
pub trait TaskReport: Sync {
    /// Origin of the claims, as it follows the word "claims".
    fn whose(&self) -> &'static str;

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
    fn verdict(&self, recording: &Recording, summary: &Summary) -> Markup;

    /// Sections with the measures of the run.
    fn measured(&self, recording: &Recording, summary: &Summary) -> Markup;
}

/// Maximum number of strokes in a table.
const MAX_SHOWN: usize = 100;

/// Strokes to show in a table (the first and the last, if there are many), and a note about the omitted ones.
fn shown<S>(strokes: &[S]) -> (Vec<&S>, Markup) {
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

/// Control law of the paper.
const PAPERS_LAW: &str = "tri-axial";

/// Number of strokes that the paper's claims refer to.
pub(crate) const PAPERS_STROKES: u32 = 4;

/// Number of fingers of the paper's hand, and of elements per fingertip (section II).
const PAPERS_FINGERS: usize = 2;
const PAPERS_ELEMENTS: usize = 41;

/// `true` if the hand is like the paper's as far as is known; the bounds of the paper's claims were chosen for it.
pub(crate) fn is_papers_hand(facts: &RunFacts) -> bool {
    let mut elements = facts.hand.iter().map(|finger| finger.element_tips.len());
    facts.fingers == PAPERS_FINGERS && elements.all(|count| count == PAPERS_ELEMENTS)
}

/// `true` if the task's claims apply to runs with these facts. The paper's claims require its law.
pub fn claims_apply(facts: &RunFacts) -> bool {
    let another_law = facts.law.as_deref().is_some_and(|law| law != PAPERS_LAW);
    !(another_law && of(facts).whose() == PAPERS)
}

/// `true` if reports of runs with these facts show the task's claims. The paper's claims require enough planned
/// strokes.
pub fn claims_are_shown(facts: &RunFacts) -> bool {
    let too_few = facts.stroke_count < PAPERS_STROKES;
    claims_apply(facts) && !(too_few && of(facts).whose() == PAPERS)
}

/// `true` if the claims that hold for any hand, not only the reference hand, apply: a cap is screwed in at least as many
/// strokes as in the paper.
pub(crate) fn is_for_any_hand(recording: &Recording) -> bool {
    recording.facts.stroke_count >= PAPERS_STROKES && of_recording(recording).whose() == PAPERS
}

/// Claims shown in a report, and their origin.
pub(crate) fn shown_claims<'a>(
    recording: &Recording,
    summary: &'a Summary,
) -> (&'a [Claim], &'static str) {
    let whose = match summary.claims.is_empty() {
        true => ANY_HANDS,
        false => of_recording(recording).whose(),
    };
    (summary.shown_claims(), whose)
}

/// Task-specific report for these facts; unknown tasks use the report of the screw task.
pub fn of(facts: &RunFacts) -> &'static dyn TaskReport {
    match &facts.task {
        TaskKind::Carry => &carry::CarryReport,
        TaskKind::Contour => &contour::ContourReport,
        TaskKind::FrictionScan => &friction_scan::FrictionScanReport,
        _ if facts.cap.is_some() => &cap::CapReport,
        _ => &screw::ScrewReport,
    }
}

/// Like [`of`], but also detects from the findings that a cap was screwed by touch.
pub fn of_recording(recording: &Recording) -> &'static dyn TaskReport {
    match is_felt(recording) {
        true => &cap::CapReport,
        false => of(&recording.facts),
    }
}
