//! Columns of claims in the table of trials.

use feeler_report::{Claim, DecidedBy, Summary};

/// Columns of one claim in the table of trials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClaimColumns {
    /// Id of the claim. Its columns are `claim.ID`, `claim.ID.value` and `claim.ID.margin`.
    pub id: &'static str,
    /// Parts of the rig that decide the result of the claim: the hand alone, or the hand and the bottle.
    pub decided_by: Option<DecidedBy>,
    /// `true` if the claim applies to any hand instead of to the task.
    pub of_any_hand: bool,
}

impl ClaimColumns {
    /// Returns the columns of all claims in `summary`. The claims of the task are included for every law so that the
    /// tables of different laws have the same columns.
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

    /// Name of the column with the result of the claim, 1 (pass) or 0 (fail).
    pub fn holds(&self) -> String {
        format!("claim.{}", self.id)
    }

    /// Name of the column with the claim's first value.
    pub fn value(&self) -> String {
        format!("claim.{}.value", self.id)
    }

    /// Name of the column with the claim's margin.
    pub fn margin(&self) -> String {
        format!("claim.{}.margin", self.id)
    }
}
