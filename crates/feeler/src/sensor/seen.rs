//! Where a camera sees elements, and how their frames lie in its picture.

use super::dome::DomeProjection;
use super::layout::SensingElement;
use glam::DVec2;

/// An element as the camera sees it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SeenElement {
    /// Column and row of its centre, px.
    pub centre_px: DVec2,
    /// Direction of x of its frame `E_i` in the picture, rad, from the columns' direction (to the right) towards the rows' (down); 0
    /// where lengths are px, as the frame is the picture's then. Its y is a right angle further, and its z away from the camera.
    pub x_angle: f64,
}

impl SeenElement {
    /// An element on a dome; none where the camera does not see its tip.
    pub fn on_dome(
        projection: &DomeProjection,
        dome_radius: f64,
        element: &SensingElement,
    ) -> Option<Self> {
        /// Length along x over the dome's radius: short enough for a tangent, long enough for the numbers.
        const STEP: f64 = 1e-4;
        let tip = dome_radius * element.normal();
        let aside = STEP * dome_radius * element.rotation.x_axis;
        let along = projection.project(tip + aside)? - projection.project(tip - aside)?;
        Some(Self {
            centre_px: projection.project(tip)?,
            x_angle: along.to_angle(),
        })
    }
}
