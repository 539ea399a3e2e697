//! Task-specific parts of reports: claims, measures and figures.

mod cap;
pub(crate) mod carry;
pub mod contour;
mod friction_scan;
mod grip;
pub(crate) mod papers_setup;
mod screw;
mod task_report;

pub use papers_setup::{claims_apply, claims_are_shown};
pub use task_report::TaskReport;

use crate::measures::cap::is_felt;
use crate::measures::claim::Claim;
use crate::measures::summary::Summary;
use feeler_record::{Recording, RunFacts, TaskKind};

/// Origin of the claims that apply to any hand, as it is printed after the word "claims".
const ANY_HANDS: &str = "of any hand";

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
        TaskKind::Grip => &grip::GripReport,
        _ if facts.cap.is_some() => &cap::CapReport,
        _ => &screw::ScrewReport,
    }
}

/// Like [`of`], but also recognizes from the recorded findings that a cap was screwed until the hand detected the
/// outcome by touch.
pub fn of_recording(recording: &Recording) -> &'static dyn TaskReport {
    match is_felt(recording) {
        true => &cap::CapReport,
        false => of(&recording.facts),
    }
}
