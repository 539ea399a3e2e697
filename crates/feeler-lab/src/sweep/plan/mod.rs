//! Parameters of a sweep and the distributions of their values.

pub(crate) mod design;
pub(crate) mod distribution;
pub(crate) mod multiplier;
pub(crate) mod parameter;
pub(crate) mod plan_file;
pub(crate) mod plausible;
pub mod ranges;

pub use design::{Design, MAX_ROWS};
pub use plan_file::{PLAN, Plan};
