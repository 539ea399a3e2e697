//! `summary.json`: the measures of a run, with stable keys.

use super::cap::CapMeasures;
use super::claim::Claim;
use super::criterion::Success;
use super::stroke_pattern::StrokePattern;
use super::strokes::StrokeMeasures;
use feeler_record::{FindingName, RunState, SensingKind, TaskKind, TaskOutcome};
use serde::Serialize;
use std::collections::BTreeMap;

/// Measures of a run. The field names are the keys of `summary.json`; unknown values are null.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the experiment.
    pub experiment: String,
    /// Task of the run.
    pub task: TaskKind,
    /// Seed of all random quantities.
    pub seed: u64,
    /// Version of feeler that made the run.
    pub version: String,
    /// Source of forces: `image` or `direct`.
    pub sensing: SensingKind,
    /// Final state: `done`, `given_up` or `interrupted`.
    pub state: RunState,
    /// Reason if the run is not done.
    pub reason: Option<String>,
    /// Recorded time of the run (s).
    pub sim_time: f64,
    /// Wall-clock duration of the run (s).
    pub wall_time: Option<f64>,
    /// Ratio of `sim_time` to `wall_time`.
    pub real_time_factor: Option<f64>,
    /// Strokes in chronological order.
    pub strokes: Vec<StrokeMeasures>,
    /// Comparison of the strokes with the paper's Fig. 8; `None` unless strokes 1 to 4 were measured.
    pub stroke_pattern: Option<StrokePattern>,
    /// Outcome of the task, if the task determined one.
    pub outcome: Option<TaskOutcome>,
    /// Findings of the task by name, in SI units.
    pub findings: BTreeMap<FindingName, Option<f64>>,
    /// Claims of the task. The paper's claims are omitted if its law or its strokes did not run.
    pub claims: Vec<Claim>,
    /// Claims about any hand that screws a cap in at least four strokes, under any law.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hand_claims: Vec<Claim>,
    /// Measures of closing or opening a cap by touch; `None` if the strokes were only counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cap: Option<CapMeasures>,
    /// Result of the success criterion, set when a report is created; `None` (no key in JSON) before that, or if the
    /// cap's motion is unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub success: Option<Success>,
    /// Final rotation of the cap (rad), positive = closing; `None` for tasks that do not screw.
    pub cap_angle: Option<f64>,
    /// Peak torque of the last stroke (N·m); `None` for tasks that do not screw.
    pub final_torque: Option<f64>,
    /// Largest normal force on an element over all strokes (N).
    pub peak_element_force: Option<f64>,
    /// Digest of the recording.
    pub digest: String,
}

impl Summary {
    /// Claims shown in a report: those of the task or, if it has no claims, those about any hand.
    pub fn shown_claims(&self) -> &[Claim] {
        match self.claims.is_empty() {
            true => &self.hand_claims,
            false => &self.claims,
        }
    }

    /// Text of `summary.json`.
    ///
    /// # Errors
    /// Never for a valid summary; required by serde's signature.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|json| json + "\n")
    }
}
