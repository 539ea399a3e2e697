//! Things to touch: a shape of the geometry library, queried for its surface.

use glam::DVec3;
use parry3d_f64::math::Vector;
use parry3d_f64::shape::{Cylinder, Shape};

/// A rigid shape in its own frame: origin at its centre, z along its axis.
pub struct Object {
    shape: Box<dyn Shape>,
    /// Half the size of the box around the shape, m.
    half_size: DVec3,
}

/// The point of a surface that is nearest to a query point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// The point, m, in the object's frame.
    pub position: DVec3,
    /// The outward unit normal there, in the object's frame.
    pub normal: DVec3,
    /// Distance of the query point from the surface, m; negative inside.
    pub distance: f64,
}

impl Object {
    /// An upright cylinder of `radius` and `height`, m.
    pub fn cylinder(radius: f64, height: f64) -> Self {
        Self {
            shape: Box::new(Cylinder::new(height / 2.0, radius)),
            half_size: DVec3::new(radius, radius, height / 2.0),
        }
    }

    /// Whether `point` (m, object's frame) lies within `margin` (m) of the box around the shape:
    /// the cheap test that spares most feelers the query of the surface.
    pub fn is_near(&self, point: DVec3, margin: f64) -> bool {
        point
            .abs()
            .cmple(self.half_size + DVec3::splat(margin))
            .all()
    }

    /// The surface point nearest to `point` (m, object's frame), or `None` when `point` lies on the
    /// surface to within rounding, where the direction to it tells no normal.
    pub fn nearest(&self, point: DVec3) -> Option<SurfacePoint> {
        let projection = self
            .shape
            .project_local_point(to_library_axes(point), false);
        let position = from_library_axes(projection.point);
        let outward = if projection.is_inside {
            position - point
        } else {
            point - position
        };
        let (normal, length) = outward.normalize_and_length();
        (length > f64::EPSILON).then_some(SurfacePoint {
            position,
            normal,
            distance: if projection.is_inside {
                -length
            } else {
                length
            },
        })
    }
}

/// The library's cylinders stand along y, ours along z.
fn to_library_axes(p: DVec3) -> Vector {
    Vector::new(p.x, p.z, -p.y)
}

fn from_library_axes(p: Vector) -> DVec3 {
    DVec3::new(p.x, -p.z, p.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_and_normal_of_a_cylinder_match_its_closed_form() {
        let object = Object::cylinder(0.014, 0.020);
        let side = object.nearest(DVec3::new(0.0, 0.016, 0.003)).unwrap();
        assert!((side.distance - 0.002).abs() < 1e-12);
        assert!((side.normal - DVec3::Y).length() < 1e-12);
        let inside = object.nearest(DVec3::new(0.013, 0.0, 0.0)).unwrap();
        assert!((inside.distance + 0.001).abs() < 1e-12);
        assert!((inside.normal - DVec3::X).length() < 1e-12);
        let top = object.nearest(DVec3::new(0.001, 0.002, 0.013)).unwrap();
        assert!((top.distance - 0.003).abs() < 1e-12);
        assert!((top.normal - DVec3::Z).length() < 1e-12);
    }

    #[test]
    fn the_box_around_the_shape_never_hides_a_near_point() {
        let object = Object::cylinder(0.014, 0.020);
        assert!(object.is_near(DVec3::new(0.0154, 0.0, 0.0114), 0.0015));
        assert!(!object.is_near(DVec3::new(0.0156, 0.0, 0.0), 0.0015));
    }
}
