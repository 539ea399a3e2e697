//! Messages of a recording and the facts in its header.

pub(crate) mod chain;
pub(crate) mod channels;
pub(crate) mod contact;
pub(crate) mod efforts;
pub(crate) mod facts;
pub(crate) mod felt;
pub(crate) mod image;
mod joint_array;
pub(crate) mod model;
pub(crate) mod names;
pub(crate) mod recorded;
pub(crate) mod run_end;
pub(crate) mod topic;

pub use model::{FingerModel, FingerPart, Frame, WORLD_FRAME, frame, joint_names};
