//! Topics and files for viewers: scene, markers, robot description.

pub(crate) mod scene;
pub(crate) mod urdf;
pub(crate) mod viewer_log;

pub use urdf::urdf;
