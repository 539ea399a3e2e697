//! Positions of elements in a camera's image, and orientation of their frames there.

use crate::sensor::fingertip::dome::DomeProjection;
use crate::sensor::fingertip::layout::SensingElement;
use glam::DVec2;

/// Position and orientation of an element in the camera's image.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProjectedElement {
    /// Column and row of the element's centre, px.
    pub centre_px: DVec2,
    /// Direction of x of the element's frame `E_i` in the image, rad, from the columns' direction (right) towards the
    /// rows' direction (down). 0 if lengths are in px, because the frame is then parallel to the image. y is rotated
    /// further by a right angle, and z points away from the camera.
    pub x_angle: f64,
}

impl ProjectedElement {
    /// Projects an element on a dome to the image; `None` if its tip is outside the camera's view.
    pub fn on_dome(projection: &DomeProjection, element: &SensingElement) -> Option<Self> {
        /// Step along x for the numerical tangent, relative to the dome's radius: a compromise between curvature and
        /// rounding.
        const STEP: f64 = 1e-4;
        let dome_radius = projection.dome_radius();
        let tip = dome_radius * element.normal();
        let aside = STEP * dome_radius * element.rotation.x_axis;
        let along = projection.project(tip + aside)? - projection.project(tip - aside)?;
        Some(Self {
            centre_px: projection.project(tip)?,
            x_angle: along.to_angle(),
        })
    }
}
