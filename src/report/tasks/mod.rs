//! What a report shows of each task: the claims that it is held to, and its figures.

mod carry;
mod contour;

use super::claim::Claim;
use super::claims::claims as screw_claims;
use super::figures::Figure;
use super::figures::figures as screw_figures;
use super::run_data::RunData;
use crate::record::Recording;

/// The claims that a run is held to.
pub fn claims(recording: &Recording, data: &RunData) -> Vec<Claim> {
    match recording.facts.task.as_str() {
        "screw" => screw_claims(data),
        "contour" => contour::claims(recording),
        "carry" => carry::claims(recording, data),
        _ => Vec::new(),
    }
}

/// The figures of a run.
pub fn figures(recording: &Recording, data: &RunData) -> Vec<Figure> {
    match recording.facts.task.as_str() {
        "screw" => screw_figures(data),
        "contour" => contour::figures(recording, data),
        "carry" => carry::figures(recording, data),
        _ => Vec::new(),
    }
}

/// What the claims of a task are called: the paper makes claims of the screwing alone.
pub fn claims_heading(task: &str) -> &'static str {
    match task {
        "screw" => "The paper's claims",
        _ => "What the task is held to",
    }
}
