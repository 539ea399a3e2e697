//! `summary.json`: a run in numbers, with stable keys.

use super::cap::CapMeasures;
use super::claim::Claim;
use super::claims::of_any_hand;
use super::criterion::Success;
use super::run_data::RunData;
use super::series::{finite, maximum};
use super::stroke_pattern::StrokePattern;
use super::strokes::StrokeMeasures;
use super::tasks;
use feeler_record::{FindingName, Recording, RunState, SensingKind, TaskKind, TaskOutcome};
use serde::Serialize;
use std::collections::BTreeMap;

/// A run in numbers. The field names are the keys of `summary.json`; what is not known is null.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the experiment.
    pub experiment: String,
    /// Which task it was.
    pub task: TaskKind,
    /// Seed of every random quantity.
    pub seed: u64,
    /// Version of the program that ran it.
    pub version: String,
    /// How forces were obtained: `image` or `direct`.
    pub sensing: SensingKind,
    /// How the run ended: `done`, `given_up` or `interrupted`.
    pub state: RunState,
    /// Why it is not done, if it is not.
    pub reason: Option<String>,
    /// Time of the run that is on record, s.
    pub sim_time: f64,
    /// Wall time that the run took, s.
    pub wall_time: Option<f64>,
    /// `sim_time / wall_time`.
    pub real_time_factor: Option<f64>,
    /// The strokes, in the order of time.
    pub strokes: Vec<StrokeMeasures>,
    /// Whether the strokes go up and down as in the paper's Fig. 8, if there are four.
    pub stroke_pattern: Option<StrokePattern>,
    /// What came of the task, if it could tell.
    pub outcome: Option<TaskOutcome>,
    /// What the task found out, by name, in SI units.
    pub findings: BTreeMap<FindingName, Option<f64>>,
    /// The claims of the task; empty if they are those of the paper, and its law or its strokes did not run.
    pub claims: Vec<Claim>,
    /// The claims of any hand that screws a cap in at least four strokes, under whatever law.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hand_claims: Vec<Claim>,
    /// How the cap was closed or opened, where that was not merely a count of strokes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cap: Option<CapMeasures>,
    /// Whether the run was a success, as a report judges it; `None` (no key in JSON) before that, and where nobody knows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub success: Option<Success>,
    /// Angle the cap has turned at the end, rad, positive = closing.
    pub cap_angle: Option<f64>,
    /// Largest torque of the last stroke, N·m, where an object is screwed.
    pub final_torque: Option<f64>,
    /// Largest force on an element in its frame's z, of all strokes, N.
    pub peak_element_force: Option<f64>,
    /// Digest of the recording's content.
    pub digest: String,
}

impl Summary {
    /// Summarises a recording.
    pub fn new(recording: &Recording, data: &RunData) -> Self {
        let facts = &recording.facts;
        let found = recording.findings.last();
        let factor = |seconds| finite(recording.readable_until / seconds);
        let strokes = data.stroke_measures();
        let claims = tasks::of_recording(recording).claims(recording, data, &strokes);
        let hand_claims = match tasks::is_for_any_hand(recording) {
            true => of_any_hand(data, &strokes),
            false => Vec::new(),
        };
        Self {
            experiment: facts.experiment.clone(),
            task: facts.task.clone(),
            seed: facts.seed,
            version: facts.version.clone(),
            sensing: facts.sensing.clone(),
            state: recording.end.state,
            reason: recording.end.reason.clone(),
            sim_time: recording.readable_until,
            wall_time: recording.wall_time,
            real_time_factor: recording.wall_time.and_then(factor),
            stroke_pattern: StrokePattern::new(&strokes),
            final_torque: strokes.last().and_then(|stroke| stroke.peak_torque),
            peak_element_force: maximum(strokes.iter().filter_map(|s| s.peak_element_force)),
            strokes,
            outcome: found.and_then(|f| f.outcome.clone()),
            findings: (found.into_iter())
                .flat_map(|f| f.names.iter().cloned().zip(&f.values))
                .map(|(name, &value)| (name, finite(value)))
                .collect(),
            claims,
            hand_claims,
            cap: CapMeasures::new(recording, data),
            success: None,
            cap_angle: (recording.cap.last()).and_then(|cap| finite(cap.angle)),
            digest: recording.digest.to_string(),
        }
    }

    /// The claims that a report shows: those of the task or, if there are none, those of any hand.
    pub fn shown_claims(&self) -> &[Claim] {
        match self.claims.is_empty() {
            true => &self.hand_claims,
            false => &self.claims,
        }
    }

    /// The text of `summary.json`.
    ///
    /// # Errors
    /// None that a summary can cause; serde's signature has one.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|json| json + "\n")
    }
}
