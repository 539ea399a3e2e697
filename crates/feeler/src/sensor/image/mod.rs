//! Images, cameras, exposure and the pixels of each sensing element.

pub(crate) mod camera;
pub(crate) mod cells;
pub(crate) mod difference;
pub(crate) mod exposure;
pub(crate) mod folds;
pub(crate) mod frame;
pub(crate) mod polarity;
pub(crate) mod radial_distortion;
pub(crate) mod seen;
pub(crate) mod subregion;

pub use camera::{Camera, CameraError, CaptureReport, check_frame_size};
pub use exposure::{DEFAULT_MAX_SATURATED, Exposure, SATURATED, SaturationCheck};
pub use frame::{Frame, Picture};
pub use polarity::Polarity;
pub use seen::ProjectedElement;
pub use subregion::{WeightedPixel, subregion};
