//! Simulated images of the camera in a fingertip: spots of conical feelers, printed markers, gels, noise.

pub(crate) mod at_rest;
pub(crate) mod camera;
pub(crate) mod camera_noise;
pub(crate) mod config;
pub(crate) mod drawn_blocks;
pub(crate) mod error;
pub(crate) mod gaussian_noise;
pub(crate) mod gel;
pub(crate) mod markers;
pub(crate) mod model;
pub(crate) mod picture;
pub(crate) mod renderer;
pub(crate) mod spot;

pub use camera::SimCamera;
pub use config::OpticsConfig;
pub use error::OpticsError;
pub use gel::GelLayer;
pub use markers::MarkerConfig;
pub use model::{CONES, OpticsModel};
pub use picture::{PictureError, View, draw};
pub use renderer::{OpticsScratch, render};
