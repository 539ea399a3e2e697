//! Topics and files for viewers: scene, markers, robot description.

pub(crate) mod kinematic_messages;
pub(crate) mod scene;
pub(crate) mod urdf;
pub(crate) mod viewer_log;

pub use kinematic_messages::KinematicMessages;
pub use urdf::urdf;
