//! The true section of an object, for what is measured against it.

use super::object::Object;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Points of a section: at 20 mm from the middle they are 0.09 mm apart.
const POINTS: u32 = 1440;
/// A point is on the surface within this distance, m.
const TOLERANCE: f64 = 1e-9;
/// Steps towards the surface: each goes as far as nothing can be in the way.
const MAX_STEPS: usize = 2000;

/// The horizontal section of `object` where it stands at the start, at `height` (m, in W): points in W,
/// counterclockwise, of what can be seen from the object's origin. Empty where the section has no end, or does not
/// go round the origin.
pub fn section(object: &Object, height: f64) -> Vec<[f64; 2]> {
    let Some((half, middle)) = object.shape.bounds() else {
        return Vec::new();
    };
    let reach = 1.1 * (half.length() + middle.length() + object.offset.length());
    let angles = (0..POINTS).map(|i| TAU * f64::from(i) / f64::from(POINTS));
    let points = angles.map(|angle| meet(object, height, DVec2::from_angle(angle), reach));
    let points: Option<Vec<_>> = points.collect();
    points.unwrap_or_default()
}

/// Where a point that comes in along `-direction` from `reach` off the origin meets the surface.
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
