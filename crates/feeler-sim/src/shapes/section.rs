//! Ground truth of an object's cross-section, for comparison with measurements.

use crate::objects::object::Object;
use feeler::math::direction_at;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Number of points of a section: 0.09 mm apart at 20 mm from the centre.
const POINTS: u32 = 1440;
/// Tolerance of a point's distance from the surface (m).
const TOLERANCE: f64 = 1e-9;
/// Maximum number of steps of sphere tracing.
const MAX_STEPS: usize = 2000;

/// Horizontal section of `object` in its start pose, at `height` in W (m): points in W, counterclockwise, that are
/// visible from the outside in the direction of the object's origin. Empty if the object is unbounded, or if the
/// section does not surround the origin.
pub fn section(object: &Object, height: f64) -> Vec<[f64; 2]> {
    let Some((half, middle)) = object.shape.bounds() else {
        return Vec::new();
    };
    let reach = 1.1 * (half.length() + middle.length() + object.offset.length());
    let angles = (0..POINTS).map(|i| TAU * f64::from(i) / f64::from(POINTS));
    let points = angles.map(|angle| meet(object, height, direction_at(angle), reach));
    let points: Option<Vec<_>> = points.collect();
    points.unwrap_or_default()
}

/// Point (x, y) at `height` in which the ray along `-direction` from `reach * direction` meets the surface. `None` if it misses.
fn meet(object: &Object, height: f64, direction: DVec2, reach: f64) -> Option<[f64; 2]> {
    let origin = object.start.position.with_z(height);
    let mut distance = reach;
    for _ in 0..MAX_STEPS {
        let point = origin + distance * direction.extend(0.0);
        let here = object.start.rotation.transpose() * (point - object.start.position);
        let clearance = object.nearest(here).map_or(0.0, |surface| surface.distance);
        if clearance <= TOLERANCE {
            let DVec3 { x, y, .. } = point;
            return Some([x, y]);
        }
        distance -= clearance;
        if distance <= 0.0 {
            return None;
        }
    }
    None
}
