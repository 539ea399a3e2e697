//! Geometry of fingertips: sensing elements, dome, located layouts.

pub(crate) mod dome;
pub(crate) mod layout;
pub(crate) mod located_layout;
pub(crate) mod made_for;
pub(crate) mod model;

pub use dome::{CameraConfig, DomeError, DomeProjection};
pub use layout::{
    ElementLayout, GridConfig, LayoutConfig, MAX_ELEMENTS, RingConfig, SensingElement,
};
pub use located_layout::{
    DomeGeometry, ElementPlace, LAYOUT_VERSION, LayoutError, LocatedLayout, MAX_LOCATED_ELEMENTS,
};
pub use made_for::{CalibrationTarget, LengthUnit, sha256};
pub use model::{Fingertip, FingertipConfig, FingertipError};
