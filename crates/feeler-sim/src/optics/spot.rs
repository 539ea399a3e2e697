//! Spots in the image of a fingertip: contacts of cones, or markers.

use glam::DVec2;

/// A spot of an element: the contact of a cone, or a marker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Load of the cone, or of the marker's element (N).
    pub load: f64,
    /// Centre, x and y in the element's frame `E_i` (m).
    pub centre: DVec2,
    /// Radius of the contact or marker (m).
    pub radius: f64,
    /// Contrast with the dome, relative to the configured contrast.
    pub contrast: f64,
}
