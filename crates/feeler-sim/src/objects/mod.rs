//! Objects that the fingers touch: fixed, moved, held, free, or with a thread.

pub(crate) mod free_bodies;
pub(crate) mod holder;
pub(crate) mod object;
pub(crate) mod pose;
pub(crate) mod thread;
pub(crate) mod thread_config;

pub use holder::{HolderConfig, LateralConfig, PlaySpring};
pub use object::{FreeConfig, Motion, MotionConfig, Object, ObjectConfig};
pub use pose::Pose;
pub use thread::{FingerLoad, Hinge, ThreadConfig, Turn};
pub use thread_config::{HingeConfig, ThreadFault};
