//! Evaluation of the success criterion of a run.

use super::claim::Claim;
use super::criterion::{Criterion, Success};
use super::strokes::{StrokeMeasures, found_closed, turned};
use super::summary::Summary;
use feeler_record::{RunFacts, RunState, TaskKind};

impl Criterion {
    /// Claims that the criterion includes; may be empty.
    pub fn claims(self, summary: &Summary) -> Vec<&Claim> {
        let required = |of_any_hand| move |claim: &&Claim| self.requires(claim.id, of_any_hand);
        let own = summary.claims.iter().filter(required(false));
        own.chain(summary.hand_claims.iter().filter(required(true)))
            .collect()
    }

    /// `true` if a completed run meets the criterion.
    pub fn holds(self, summary: &Summary) -> bool {
        let outcome = summary.outcome.as_ref();
        let cap = summary.cap.as_ref();
        let apart_from_claims = match self {
            Self::Turned => turns_or_closes(&summary.strokes),
            Self::ClosedWell => cap.is_some_and(|cap| cap.closed_well(outcome)),
            Self::OpenedWell => cap.is_some_and(|cap| cap.opened_well(outcome)),
            Self::Claims | Self::AnyHand | Self::Closed | Self::Done => true,
        };
        apart_from_claims && self.claims(summary).iter().all(|claim| claim.holds)
    }
}

fn turns_or_closes(strokes: &[StrokeMeasures]) -> bool {
    let turns: Vec<_> = strokes.iter().map(|stroke| stroke.cap_turn).collect();
    turned(&turns) || found_closed(&turns)
}

impl Success {
    /// Evaluates a simulated run with these facts; `None` if it screwed a cap whose motion is unknown.
    pub fn of(facts: &RunFacts, summary: &Summary) -> Option<Self> {
        if facts.task == TaskKind::Screw && facts.cap_radius == 0.0 {
            return None;
        }
        let criterion = Criterion::of(facts, false);
        let met = summary.state == RunState::Done && criterion.holds(summary);
        Some(Self { met, criterion })
    }
}
