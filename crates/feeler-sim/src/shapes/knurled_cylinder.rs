//! Exact nearest point on an upright cylinder with a knurled, slightly oval side.
//!
//! The solid is an extruded plane region, so the problem reduces to the nearest point on the region's edge, a curve.

mod curve;

use super::surface_point::SurfacePoint;
use curve::Curve;
use glam::DVec3;

/// An upright cylinder (origin at the centre, z along the axis) whose side has the radius
/// `r(phi) = radius (1 + ovality cos 2 phi) + depth / 2 (cos(knurls phi) - 1)`.
#[derive(Debug, Clone)]
pub struct KnurledCylinder {
    curve: Curve,
    half_height: f64,
}

impl KnurledCylinder {
    /// Creates a cylinder of `radius` (m; at the crests, for an `ovality` of 0) and `height` (m), with `knurls` grooves
    /// of `depth` (m). `radius (1 - |ovality|)` must exceed `depth`. The time of a query from far away grows with
    /// `knurls`.
    pub fn new(radius: f64, height: f64, knurls: u32, depth: f64, ovality: f64) -> Self {
        Self {
            curve: Curve::new(radius, knurls, depth, ovality),
            half_height: height / 2.0,
        }
    }

    /// Surface point nearest to `point` (m, object's frame). `None` if `point` is not finite, or is on the rim, up to
    /// rounding, where the normal is undefined.
    pub fn nearest(&self, point: DVec3) -> Option<SurfacePoint> {
        if !point.is_finite() {
            return None;
        }
        let plane = point.truncate();
        let above = point.z.abs() - self.half_height;
        // Above or below an end, the side is at least as far away as the innermost radius.
        let inside = self.curve.innermost_radius() - plane.length();
        if inside > 0.0 && above > -inside {
            return Some(self.on_end(point, above));
        }
        let (edge, normal, side) = self.curve.nearest(plane);
        if above > 0.0 && side > 0.0 || above.abs().max(side.abs()) <= f64::EPSILON {
            let position = edge.extend(self.half_height.copysign(point.z));
            let (normal, distance) = (point - position).normalize_and_length();
            return (distance > f64::EPSILON).then_some(SurfacePoint {
                position,
                normal,
                distance,
            });
        }
        if above > side {
            return Some(self.on_end(point, above));
        }
        Some(SurfacePoint {
            position: edge.extend(point.z),
            normal: normal.extend(0.0),
            distance: side,
        })
    }

    fn on_end(&self, point: DVec3, above: f64) -> SurfacePoint {
        SurfacePoint {
            position: DVec3::new(point.x, point.y, self.half_height.copysign(point.z)),
            normal: DVec3::Z * 1.0_f64.copysign(point.z),
            distance: above,
        }
    }
}
