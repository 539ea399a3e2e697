//! Result of a nearest-point query.

use glam::DVec3;

/// The surface point nearest to a query point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Position in the shape's frame (m).
    pub position: DVec3,
    /// Outward unit normal in the shape's frame.
    pub normal: DVec3,
    /// Signed distance of the query point from the surface (m); negative inside.
    pub distance: f64,
}
