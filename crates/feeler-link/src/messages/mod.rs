//! Messages of the link and their validation.

pub(crate) mod decode;
#[macro_use]
mod definition;
pub(crate) mod freshness;
pub(crate) mod instruments;
pub(crate) mod joints;
pub mod message;
pub(crate) mod mismatch;
pub(crate) mod plausible;
pub(crate) mod printable;
pub(crate) mod rejection;
pub(crate) mod sequence;
pub(crate) mod tactile;

pub use freshness::{Echo, SentSteps};
pub use joints::JointCounts;
pub use message::{HandMode, StopInForce};
pub use mismatch::Mismatch;
pub use rejection::Rejection;
