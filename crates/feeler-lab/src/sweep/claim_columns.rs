//! The columns that claims have in the table of trials.

use feeler_report::{Claim, DecidedBy, Summary};

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
