//! What the report of each task shows that no other task's does: its claims, measures and figures.

mod cap;
pub(crate) mod carry;
pub mod contour;
mod findings;
mod friction_scan;
mod screw;

use super::cap::is_felt;
use super::claim::Claim;
use super::figures::Figure;
use super::make::SUMMARY;
use super::run_data::RunData;
use super::strokes::StrokeMeasures;
use super::summary::Summary;
use feeler_record::{Recording, RunFacts, TaskKind};
use maud::{Markup, html};

/// Whose the claims of the screw task are.
pub(crate) const PAPERS: &str = "of the paper";

/// Whose the claims are that hold a hand to what a user wants of it.
const ANY_HANDS: &str = "of any hand";

/// The part of a report that a task brings.
pub trait TaskReport: Sync {
    /// Whose its claims are, after the word "claims".
    fn whose(&self) -> &'static str;

    /// Its claims about a run whose [`stroke_measures`](RunData::stroke_measures) are `strokes`.
    fn claims(
        &self,
        recording: &Recording,
        data: &RunData,
        strokes: &[StrokeMeasures],
    ) -> Vec<Claim>;

    /// Its figures.
    fn figures(&self, recording: &Recording, data: &RunData) -> Vec<Figure>;

    /// What came of the run, in a sentence.
    fn verdict(&self, recording: &Recording, summary: &Summary) -> Markup;

    /// What the run measured: sections with headings.
    fn measured(&self, recording: &Recording, summary: &Summary) -> Markup;
}

/// Strokes that a table shows at most.
const MOST_SHOWN: usize = 100;

/// The strokes that a table shows, the first and the last of many, and a note about the others.
fn shown<S>(strokes: &[S]) -> (Vec<&S>, Markup) {
    let left_out = strokes.len().saturating_sub(MOST_SHOWN);
    let shown = if left_out > 0 {
        MOST_SHOWN / 2
    } else {
        strokes.len()
    };
    let (first, rest) = strokes.split_at(shown);
    let last = &rest[rest.len().saturating_sub(MOST_SHOWN / 2)..];
    let note = html! {
        @if left_out > 0 {
            p.note {
                "Left out here are " (left_out) " strokes in the middle; " code { (SUMMARY) } " has them all."
            }
        }
    };
    (first.iter().chain(last).collect(), note)
}

/// The control law of the paper.
const PAPERS_LAW: &str = "tri-axial";

/// The strokes that the paper's claims are about.
pub(crate) const PAPERS_STROKES: u32 = 4;

/// Fingers of the paper's hand, and elements of each of its fingertips (section II).
const PAPERS_FINGERS: usize = 2;
const PAPERS_ELEMENTS: usize = 41;

/// Whether runs with these facts are of a hand like the paper's, as far as is known: the bounds of its claims were chosen for that.
pub(crate) fn is_papers_hand(facts: &RunFacts) -> bool {
    let mut elements = facts.hand.iter().map(|finger| finger.element_tips.len());
    facts.fingers == PAPERS_FINGERS && elements.all(|count| count == PAPERS_ELEMENTS)
}

/// Whether the claims of the task are about runs with these facts: those of the paper only where its law ran.
pub fn claims_apply(facts: &RunFacts) -> bool {
    let another_law = facts.law.as_deref().is_some_and(|law| law != PAPERS_LAW);
    !(another_law && of(facts).whose() == PAPERS)
}

/// Whether a report of a run with these facts shows the claims: those of the paper only where their strokes were asked
/// for.
pub fn claims_are_shown(facts: &RunFacts) -> bool {
    let too_few = facts.stroke_count < PAPERS_STROKES;
    claims_apply(facts) && !(too_few && of(facts).whose() == PAPERS)
}

/// Whether the claims of any hand are about a run with this recording: a cap is screwed in as many strokes as the paper's or
/// more.
pub(crate) fn is_for_any_hand(recording: &Recording) -> bool {
    recording.facts.stroke_count >= PAPERS_STROKES && of_recording(recording).whose() == PAPERS
}

/// The claims that a report shows, and whose they are.
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

/// The report of the task of a run with these facts; of one that is not known, as of the first that there was.
pub fn of(facts: &RunFacts) -> &'static dyn TaskReport {
    match &facts.task {
        TaskKind::Carry => &carry::CarryReport,
        TaskKind::Contour => &contour::ContourReport,
        TaskKind::FrictionScan => &friction_scan::FrictionScanReport,
        _ if facts.cap.is_some() => &cap::CapReport,
        _ => &screw::ScrewReport,
    }
}

/// The same of a run with this recording, which may tell of a cap that its facts do not know.
pub fn of_recording(recording: &Recording) -> &'static dyn TaskReport {
    match is_felt(recording) {
        true => &cap::CapReport,
        false => of(&recording.facts),
    }
}
