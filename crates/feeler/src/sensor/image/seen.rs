//! Positions of elements in a camera's image, and orientation of their frames there.

use crate::sensor::fingertip::dome::DomeProjection;
use crate::sensor::fingertip::layout::SensingElement;
use glam::DVec2;

/// An element in the camera's image.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProjectedElement {
    /// Column and row of the centre, px.
    pub centre_px: DVec2,
    /// Direction of x of the element's frame `E_i` in the image, rad, from the columns' direction (right) towards the
    /// rows' direction (down). 0 if lengths are in px, as the frame is then the image's. y is rotated further by a
    /// right angle, and z points away from the camera.
    pub x_angle: f64,
}

impl ProjectedElement {
    /// Projects an element on a dome; `None` if the camera does not see its tip.
    pub fn on_dome(projection: &DomeProjection, element: &SensingElement) -> Option<Self> {
        /// Step along x relative to the dome's radius: small enough for a tangent, large enough for numerical
        /// accuracy.
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
