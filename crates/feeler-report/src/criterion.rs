//! Success criteria of runs, by their experiments' goals.

use super::claim::Claim;
use super::claims::{CLOSES_CAP, NO_DAMAGE, OVERLOADS_NOTHING};
use super::strokes::{StrokeMeasures, found_closed, turned};
use super::summary::Summary;
use super::tasks::{self, PAPERS_STROKES};
use feeler_record::{RunFacts, RunState, TaskKind};
use serde::{Serialize, Serializer};

/// What has to hold of a run whose task was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// All claims of the task; those of the paper if a cap is screwed by its hand under its law.
    Claims,
    /// All claims of any hand: a cap is screwed under other laws.
    AnyHand,
    /// The cap is closed and no element was overloaded: another hand than the paper's under its law.
    Closed,
    /// The cap was turned and no element was harmed: fewer strokes than any claim about a closed cap needs.
    Turned,
    /// The cap was found closed by touch, is tight, and no element was harmed.
    ClosedWell,
    /// The cap was found open by touch, has turned as far as was felt, and no element was harmed.
    OpenedWell,
    /// Nothing else.
    Done,
}

impl Criterion {
    /// The criterion of runs with these facts. `laws_differ` if the runs to be judged alike have different control laws.
    pub fn of(facts: &RunFacts, laws_differ: bool) -> Self {
        match (&facts.task, facts.cap) {
            (TaskKind::Contour | TaskKind::Carry | TaskKind::FrictionScan, _) => Self::Claims,
            (TaskKind::Screw, Some(cap)) if cap.sense > 0.0 => Self::ClosedWell,
            (TaskKind::Screw, Some(_)) => Self::OpenedWell,
            (TaskKind::Screw, None) if facts.stroke_count < PAPERS_STROKES => Self::Turned,
            (TaskKind::Screw, None) if laws_differ || !tasks::claims_apply(facts) => Self::AnyHand,
            (TaskKind::Screw, None) if tasks::is_papers_hand(facts) => Self::Claims,
            (TaskKind::Screw, None) => Self::Closed,
            (TaskKind::Probe | TaskKind::Other(_), _) => Self::Done,
        }
    }

    /// The criterion in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Claims => "the task was done and all its claims hold",
            Self::AnyHand => "the task was done and all five claims of any hand hold",
            Self::Closed => {
                "the task was done, the last stroke found the cap closed, and no element was overloaded"
            }
            Self::Turned => {
                "the task was done, every stroke turned the cap or the cap is closed, and no element was harmed"
            }
            Self::ClosedWell => "the cap was found closed, is tight, and no element was harmed",
            Self::OpenedWell => {
                "the cap was found open, has turned as far as was felt, and no element was harmed"
            }
            Self::Done => "the task was done",
        }
    }

    /// Whether it requires the claim with this id, which is one of any hand or of the task's own.
    pub fn requires(self, id: &str, of_any_hand: bool) -> bool {
        match self {
            Self::Claims => !of_any_hand,
            Self::AnyHand => of_any_hand,
            Self::Closed => [CLOSES_CAP, OVERLOADS_NOTHING].contains(&id),
            Self::Turned => id == NO_DAMAGE,
            Self::ClosedWell | Self::OpenedWell | Self::Done => false,
        }
    }

    /// The claims that it requires; empty if it requires none.
    pub fn claims(self, summary: &Summary) -> Vec<&Claim> {
        let required = |of_any_hand| move |claim: &&Claim| self.requires(claim.id, of_any_hand);
        let own = summary.claims.iter().filter(required(false));
        own.chain(summary.hand_claims.iter().filter(required(true)))
            .collect()
    }

    /// Whether it holds of a run whose task was done.
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

impl Serialize for Criterion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.words())
    }
}

fn turns_or_closes(strokes: &[StrokeMeasures]) -> bool {
    let turns: Vec<_> = strokes.iter().map(|stroke| stroke.cap_turn).collect();
    turned(&turns) || found_closed(&turns)
}

/// Whether a run was a success.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Success {
    /// Whether its task was done and the criterion holds.
    pub met: bool,
    /// What was to hold.
    pub criterion: Criterion,
}

impl Success {
    /// Judges a simulated run with these facts; `None` if it screwed a cap whose motion is unknown.
    pub fn of(facts: &RunFacts, summary: &Summary) -> Option<Self> {
        if facts.task == TaskKind::Screw && facts.cap_radius == 0.0 {
            return None;
        }
        let criterion = Criterion::of(facts, false);
        let met = summary.state == RunState::Done && criterion.holds(summary);
        Some(Self { met, criterion })
    }

    /// What it says beyond the claims that a report shows.
    pub fn beyond_claims(self) -> Option<String> {
        let words = self.criterion.words();
        match (self.criterion, self.met) {
            (Criterion::Claims | Criterion::AnyHand, _) => None,
            (_, true) => Some(format!("success: yes ({words})")),
            (_, false) => Some(format!("success: no (expected: {words})")),
        }
    }
}
