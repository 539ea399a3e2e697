//! An upright cylinder with a knurled, slightly oval side: its nearest surface point, exactly.
//!
//! The solid is a plane region times a range of heights, so everything comes from the nearest point
//! of the region's edge, a curve.

mod curve;

use super::shape::SurfacePoint;
use curve::Curve;
use glam::DVec3;

/// An upright cylinder in its own frame (origin at its centre, z along its axis) whose side has the
/// radius `r(phi) = radius (1 + ovality cos 2 phi) + depth / 2 (cos(knurls phi) - 1)`.
#[derive(Debug, Clone)]
pub struct KnurledCylinder {
    curve: Curve,
    half_height: f64,
}

impl KnurledCylinder {
    /// A cylinder of `radius` (at the crests, where `ovality` is 0) and `height`, m, with `knurls`
    /// grooves of `depth`, m, around it. `radius (1 - |ovality|)` must exceed `depth`;
    /// the time of a query from far away grows with `knurls`.
    pub fn new(radius: f64, height: f64, knurls: u32, depth: f64, ovality: f64) -> Self {
        Self {
            curve: Curve::new(radius, knurls, depth, ovality),
            half_height: height / 2.0,
        }
    }

    /// The surface point nearest to `point` (m, object's frame), or `None` when `point` lies on the
    /// rim to within rounding, where there is no normal, or is not finite.
    pub fn nearest(&self, point: DVec3) -> Option<SurfacePoint> {
        if !point.is_finite() {
            return None;
        }
        let plane = point.truncate();
        let above = point.z.abs() - self.half_height;
        // Under an end the side cannot be nearer than the innermost radius.
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

    /// Volume, m^3, and the moments of inertia about the axes x, y, z of the object's frame,
    /// kg m^2, of the solid at `density`, kg/m^3. The products of inertia in the plane vanish.
    pub fn volume_and_inertia(&self, density: f64) -> (f64, DVec3) {
        let (area, second) = self.curve.area_and_second_moments();
        let height = 2.0 * self.half_height;
        let upright = area * height.powi(3) / 12.0;
        let inertia = DVec3::new(
            height * second.y + upright,
            height * second.x + upright,
            height * (second.x + second.y),
        );
        (area * height, density * inertia)
    }

    fn on_end(&self, point: DVec3, above: f64) -> SurfacePoint {
        SurfacePoint {
            position: DVec3::new(point.x, point.y, self.half_height.copysign(point.z)),
            normal: DVec3::Z * 1.0_f64.copysign(point.z),
            distance: above,
        }
    }
}
