//! Statistics of trials: intervals, comparisons, sensitivity.

pub(crate) mod comparison;
pub(crate) mod interval;
pub(crate) mod law_shares;
pub(crate) mod robustness;
pub(crate) mod sensitivity;
pub(crate) mod slip_score;

pub use comparison::{Candidate, Goal, compare};
pub use interval::{Estimate, bootstrap, bootstrap_of};
pub use law_shares::{LawTrials, law_shares};
pub use robustness::robustness;
pub use slip_score::{operating_point, roc, tune};
