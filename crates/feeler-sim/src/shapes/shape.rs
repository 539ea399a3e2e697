//! Shapes of objects in their own frames: origin at the centre, z along the axis.

pub use super::shape_config::ShapeConfig;

use super::knurled_cylinder::KnurledCylinder;
use super::mesh_file::{MeshError, TriangleMesh, read_mesh};
use super::prism::{ellipse, prism, rounded};
pub use super::surface_point::SurfacePoint;
use glam::{DVec2, DVec3};
use parry3d_f64::mass_properties::MassProperties;
use parry3d_f64::math::{Pose as LibraryPose, Rotation, Vector};
use parry3d_f64::shape::{Cylinder, SharedShape, TriMeshFlags};
use std::path::{Path, PathBuf};

/// Error when creating a shape.
#[derive(Debug, thiserror::Error)]
pub enum ShapeError {
    /// The mesh file is invalid.
    #[error("{}: {source}", file.display())]
    Mesh {
        /// Path of the file.
        file: PathBuf,
        /// Error of the mesh.
        source: Box<MeshError>,
    },
    /// A section has zero area.
    #[error("the section has zero area")]
    NoArea,
    /// The mesh is rejected by the library parry, or its corners have no convex hull.
    #[error("{}: expected {expected}", file.display())]
    Unfit {
        /// Path of the file.
        file: PathBuf,
        /// Expected mesh.
        expected: &'static str,
    },
}

/// Extrudes a section to a prism.
fn drawn_out(section: &[DVec2], height: f64) -> Result<Form, ShapeError> {
    prism(section, height)
        .map(Form::Other)
        .ok_or(ShapeError::NoArea)
}

/// Reads the mesh in `file`, relative to `folder`.
fn mesh(folder: &Path, file: &Path, scale: f64) -> Result<TriangleMesh, ShapeError> {
    read_mesh(&folder.join(file), scale).map_err(|source| ShapeError::Mesh {
        file: file.to_path_buf(),
        source: Box::new(source),
    })
}

/// Side surface of an upright cylinder around the origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side {
    /// Radius (m).
    radius: f64,
    /// Half of the height (m).
    half_height: f64,
}

impl Side {
    fn of(cylinder: &Cylinder) -> Self {
        Self {
            radius: cylinder.radius,
            half_height: cylinder.half_height,
        }
    }

    /// Curvature of the path of tips' centres around the cylinder (1/m), for tips of radius `tip_radius` (m).
    #[inline(always)]
    pub fn curvature(&self, tip_radius: f64) -> f64 {
        1.0 / (self.radius + tip_radius)
    }

    /// Nearest point on the side to `point` (m), and `true` if `point` is outside the cylinder, between the planes of
    /// its ends. If `false`, the point is meaningless.
    #[inline(always)]
    pub fn nearest(&self, point: DVec3) -> (SurfacePoint, bool) {
        let away = point.truncate().length();
        let normal = DVec3::new(point.x / away, point.y / away, 0.0);
        let distance = away - self.radius;
        let position = DVec3::new(self.radius * normal.x, self.radius * normal.y, point.z);
        let surface = SurfacePoint {
            position,
            normal,
            distance,
        };
        let is_beside = point.z.abs() <= self.half_height && distance > f64::EPSILON;
        (surface, is_beside)
    }
}

/// A rigid shape in its own frame.
#[derive(Clone)]
pub struct Shape {
    form: Form,
}

#[derive(Clone)]
enum Form {
    /// Plain cylinder; a separate variant for speed, because it is the most frequent shape and touched mostly on its
    /// side.
    Cylinder(Cylinder),
    /// Knurled cylinder, and its circumscribed plain cylinder.
    Knurled(Box<KnurledCylinder>, Cylinder),
    Other(SharedShape),
}

impl Shape {
    /// Creates the shape of `config`; files are relative to `folder`.
    ///
    /// # Errors
    /// If a file cannot be read, or does not contain a valid shape.
    pub fn new(config: &ShapeConfig, folder: &Path) -> Result<Self, ShapeError> {
        let form = match config {
            &ShapeConfig::Cylinder { radius, height } => {
                Form::Cylinder(Cylinder::new(height / 2.0, radius))
            }
            &ShapeConfig::KnurledCylinder {
                radius,
                height,
                knurls,
                depth,
                ovality,
            } => Form::Knurled(
                Box::new(KnurledCylinder::new(radius, height, knurls, depth, ovality)),
                Cylinder::new(height / 2.0, radius * (1.0 + ovality.abs())),
            ),
            &ShapeConfig::EllipticCylinder { semi_axes, height } => {
                drawn_out(&ellipse(semi_axes), height)?
            }
            ShapeConfig::RoundedPrism {
                corners,
                rounding,
                height,
            } => drawn_out(&rounded(corners, *rounding), *height)?,
            &ShapeConfig::Box { size } => {
                let [x, y, z] = size.map(|s| s / 2.0);
                Form::Other(SharedShape::cuboid(x, y, z))
            }
            &ShapeConfig::Sphere { radius } => Form::Other(SharedShape::ball(radius)),
            &ShapeConfig::Capsule { radius, length } => {
                Form::Other(SharedShape::capsule_z(length / 2.0, radius))
            }
            ShapeConfig::HalfSpace => Form::Other(SharedShape::halfspace(Vector::Z)),
            ShapeConfig::ConvexHull { file, scale } => {
                let mesh = mesh(folder, file, *scale)?;
                let hull = SharedShape::convex_hull(&mesh.vertices);
                Form::Other(hull.ok_or_else(|| ShapeError::Unfit {
                    file: file.clone(),
                    expected: "corners that are not coplanar",
                })?)
            }
            ShapeConfig::Mesh { file, scale } => {
                let TriangleMesh {
                    vertices,
                    triangles,
                } = mesh(folder, file, *scale)?;
                // These flags are required to distinguish inside from outside.
                let mesh = SharedShape::trimesh_with_flags(
                    vertices,
                    triangles,
                    TriMeshFlags::ORIENTED | TriMeshFlags::FIX_INTERNAL_EDGES,
                );
                Form::Other(mesh.map_err(|_| ShapeError::Unfit {
                    file: file.clone(),
                    expected: "a mesh whose edges each join two triangles",
                })?)
            }
        };
        Ok(Self { form })
    }

    /// Surface point nearest to `point` (m, shape's frame). `None` if `point` is on the surface, up to rounding, where
    /// the direction to the nearest point defines no normal.
    pub fn nearest(&self, point: DVec3) -> Option<SurfacePoint> {
        let (position, inside) = match &self.form {
            Form::Knurled(cylinder, _) => return cylinder.nearest(point),
            Form::Cylinder(cylinder) => {
                use parry3d_f64::query::PointQuery;
                let (surface, is_beside) = Side::of(cylinder).nearest(point);
                if is_beside {
                    return Some(surface);
                }
                let projection = cylinder.project_local_point(to_library_axes(point), false);
                (from_library_axes(projection.point), projection.is_inside)
            }
            Form::Other(shape) => {
                let projection = shape.project_local_point(point, false);
                (projection.point, projection.is_inside)
            }
        };
        let outward = if inside {
            position - point
        } else {
            point - position
        };
        let (normal, length) = outward.normalize_and_length();
        (length > f64::EPSILON).then_some(SurfacePoint {
            position,
            normal,
            distance: if inside { -length } else { length },
        })
    }

    /// Side surface, if the shape is a plain cylinder.
    pub(crate) fn side(&self) -> Option<Side> {
        match &self.form {
            Form::Cylinder(cylinder) => Some(Side::of(cylinder)),
            Form::Knurled(..) | Form::Other(_) => None,
        }
    }

    /// Collision shape for parry and rapier, and its pose in the shape's frame. A knurled cylinder collides as a plain
    /// one.
    pub fn collider(&self) -> (SharedShape, LibraryPose) {
        // parry's cylinders are along y, those here along z.
        let upright = LibraryPose::from_parts(
            Vector::ZERO,
            Rotation::from_rotation_x(std::f64::consts::FRAC_PI_2),
        );
        match &self.form {
            Form::Cylinder(cylinder) | Form::Knurled(_, cylinder) => {
                (SharedShape::new(*cylinder), upright)
            }
            Form::Other(shape) => (shape.clone(), LibraryPose::IDENTITY),
        }
    }

    /// Mass, centre of mass and inertia at `density` (kg/m³), in the shape's frame.
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        let (shape, pose) = self.collider();
        shape.mass_properties(density).transform_by(&pose)
    }

    /// Half extents (m) and centre of the bounding box in the shape's frame. `None` for a half-space.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let (shape, pose) = self.collider();
        let bounds = shape.compute_aabb(&pose);
        let half = bounds.half_extents();
        (half.max_element() < 1e6).then(|| (half, bounds.center()))
    }
}

/// Rotates from z-up to parry's y-up coordinates.
fn to_library_axes(p: DVec3) -> Vector {
    Vector::new(p.x, p.z, -p.y)
}

fn from_library_axes(p: Vector) -> DVec3 {
    DVec3::new(p.x, -p.z, p.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(config: &ShapeConfig) -> Shape {
        Shape::new(config, Path::new("")).expect("a shape")
    }

    #[test]
    fn distance_and_normal_of_a_cylinder_match_its_closed_form() {
        let cylinder = shape(&ShapeConfig::Cylinder {
            radius: 0.014,
            height: 0.020,
        });
        let side = cylinder.nearest(DVec3::new(0.0, 0.016, 0.003)).unwrap();
        assert!((side.distance - 0.002).abs() < 1e-12);
        assert!((side.normal - DVec3::Y).length() < 1e-12);
        let inside = cylinder.nearest(DVec3::new(0.013, 0.0, 0.0)).unwrap();
        assert!((inside.distance + 0.001).abs() < 1e-12);
        assert!((inside.normal - DVec3::X).length() < 1e-12);
        let top = cylinder.nearest(DVec3::new(0.001, 0.002, 0.013)).unwrap();
        assert!((top.distance - 0.003).abs() < 1e-12);
        assert!((top.normal - DVec3::Z).length() < 1e-12);
    }

    #[test]
    fn all_shapes_except_half_spaces_have_bounds() {
        assert!(shape(&ShapeConfig::HalfSpace).bounds().is_none());
        let upright = shape(&ShapeConfig::Cylinder {
            radius: 0.01,
            height: 0.05,
        });
        let (half, _) = upright.bounds().unwrap();
        assert!(
            (half - DVec3::new(0.01, 0.01, 0.025)).length() < 1e-9,
            "{half}"
        );
    }
}
