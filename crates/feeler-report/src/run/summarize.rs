//! Summarizes a run.

use super::data::RunData;
use crate::claims::any_hand::of_any_hand;
use crate::measures::cap::{CapMeasures, is_felt};
use crate::measures::series::{finite, maximum};
use crate::measures::stroke_pattern::StrokePattern;
use crate::measures::summary::Summary;
use crate::tasks;
use crate::tasks::papers_setup::{PAPERS_STROKES, has_papers_claims};
use feeler_record::{Recording, TaskKind};

impl Summary {
    /// Summarizes a recording with rows `data`.
    pub fn new(recording: &Recording, data: &RunData) -> Self {
        let facts = &recording.facts;
        let found = recording.findings.last();
        let factor = |seconds| finite(recording.readable_until / seconds);
        let strokes = data.stroke_measures();
        let claims = tasks::of_recording(recording).claims(recording, data, &strokes);
        let screws = facts.task == TaskKind::Screw;
        // Claims that hold for any hand, not only the reference hand.
        let is_for_any_hand =
            has_papers_claims(facts) && !is_felt(recording) && !facts.followed_requests();
        let hand_claims = match is_for_any_hand && facts.stroke_count >= PAPERS_STROKES {
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
            final_torque: (strokes.last().filter(|_| screws)).and_then(|stroke| stroke.peak_torque),
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
            cap_angle: (recording.cap.last().filter(|_| screws)).and_then(|cap| finite(cap.angle)),
            digest: recording.digest.to_string(),
        }
    }
}
