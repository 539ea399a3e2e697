//! What makes a trial a success, beside that its task was done.

use feeler_report::strokes::found_closed;
use feeler_report::{Claim, DecidedBy, Summary};

/// What has to hold of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// All claims of the task; those of the paper if a cap is screwed under its law.
    Claims,
    /// All claims of any hand: a cap is screwed under other laws.
    AnyHand,
    /// The last stroke found the cap closed: other laws, and too few strokes for the claims of any hand.
    FoundClosed,
    /// The cap was found closed by touch, is tight, and no element was harmed.
    ClosedWell,
    /// Nothing else.
    Done,
}

impl Criterion {
    /// The criterion in words, with what it is beside.
    pub fn words(self) -> &'static str {
        match self {
            Self::Claims => "the task was done and all its claims hold",
            Self::AnyHand => "the task was done and all five claims of any hand hold",
            Self::FoundClosed => {
                "the task was done and the cap is closed: the last stroke turned it by at most 5 % of the first one's turn"
            }
            Self::ClosedWell => "the cap was found closed, is tight, and no element was harmed",
            Self::Done => "the task was done",
        }
    }

    /// Whether it holds of a run.
    pub fn holds(self, summary: &Summary) -> bool {
        let turns = || {
            summary
                .strokes
                .iter()
                .map(|s| s.cap_turn)
                .collect::<Vec<_>>()
        };
        match self {
            Self::Claims | Self::AnyHand => self.claims(summary).iter().all(|c| c.holds),
            Self::FoundClosed => found_closed(&turns()),
            Self::ClosedWell => {
                let cap = summary.cap.as_ref();
                cap.is_some_and(|cap| cap.closed_well(summary.outcome.as_ref()))
            }
            Self::Done => true,
        }
    }

    /// The claims that it requires; empty if it requires none.
    pub fn claims(self, summary: &Summary) -> &[Claim] {
        match self {
            Self::Claims => &summary.claims,
            Self::AnyHand => &summary.hand_claims,
            Self::FoundClosed | Self::ClosedWell | Self::Done => &[],
        }
    }
}

/// A claim that has columns in the table of trials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClaimColumns {
    /// The claim's id. Its columns are `claim.ID`, `claim.ID.value` and `claim.ID.margin`.
    pub id: &'static str,
    /// What decides it.
    pub decided_by: Option<DecidedBy>,
    /// Whether it is a claim of any hand, instead of the task's own.
    pub of_any_hand: bool,
}

impl ClaimColumns {
    /// The columns of all claims that `summary` could make: the task's own whatever the law, so that tables of different
    /// laws compare, and those of any hand.
    pub fn of(summary: &Summary) -> Vec<Self> {
        let columns = |of_any_hand| {
            move |claim: &Claim| Self {
                id: claim.id,
                decided_by: claim.decided_by,
                of_any_hand,
            }
        };
        let own = summary.claims.iter().map(columns(false));
        own.chain(summary.hand_claims.iter().map(columns(true)))
            .collect()
    }

    /// The column of whether it holds.
    pub fn holds(&self) -> String {
        format!("claim.{}", self.id)
    }

    /// The column of its first value.
    pub fn value(&self) -> String {
        format!("claim.{}.value", self.id)
    }

    /// The column of its margin.
    pub fn margin(&self) -> String {
        format!("claim.{}.margin", self.id)
    }
}
