//! Shapes to touch, each in a frame of its own: origin at its centre, z along its axis.

pub use super::shape_config::ShapeConfig;

use super::knurled_cylinder::KnurledCylinder;
use super::mesh_file::{MeshError, TriangleMesh, read_mesh};
use super::prism::{ellipse, prism, rounded};
use glam::{DVec2, DVec3};
use parry3d_f64::mass_properties::MassProperties;
use parry3d_f64::math::{Pose as LibraryPose, Rotation, Vector};
use parry3d_f64::shape::{Cylinder, SharedShape, TriMeshFlags};
use std::path::{Path, PathBuf};

/// Why a shape cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum ShapeError {
    /// Its file cannot be used.
    #[error("{}: {source}", file.display())]
    Mesh {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        source: Box<MeshError>,
    },
    /// A section has no area.
    #[error("expected a section with an area")]
    NoArea,
    /// The library refuses the mesh, or its corners have no hull.
    #[error("{}: expected {expected}", file.display())]
    Unfit {
        /// The file.
        file: PathBuf,
        /// What is needed.
        expected: &'static str,
    },
}

/// The prism over a section.
fn drawn_out(section: &[DVec2], height: f64) -> Result<Form, ShapeError> {
    prism(section, height)
        .map(Form::Other)
        .ok_or(ShapeError::NoArea)
}

/// The mesh in `file`, relative to `folder`.
fn mesh(folder: &Path, file: &Path, scale: f64) -> Result<TriangleMesh, ShapeError> {
    read_mesh(&folder.join(file), scale).map_err(|source| ShapeError::Mesh {
        file: file.to_path_buf(),
        source: Box::new(source),
    })
}

/// The point of a surface that is nearest to a query point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// The point, m, in the shape's frame.
    pub position: DVec3,
    /// The outward unit normal there, in the shape's frame.
    pub normal: DVec3,
    /// Distance of the query point from the surface, m; negative inside.
    pub distance: f64,
}

/// The side of a cylinder that stands along z, around the origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    /// m.
    radius: f64,
    /// m.
    half_height: f64,
}

impl Side {
    fn of(cylinder: &Cylinder) -> Self {
        Self {
            radius: cylinder.radius,
            half_height: cylinder.half_height,
        }
    }

    /// Of the way around it of tips' centres whose radius is `tip_radius`, m; 1/m.
    #[inline(always)]
    pub fn curvature(&self, tip_radius: f64) -> f64 {
        1.0 / (self.radius + tip_radius)
    }

    /// The point of the side nearest to `point`, m, and whether that is beside it: outside, below the top and above the bottom. Where it is not, the
    /// answer means nothing.
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
    /// By itself, because it is by far the most frequent, and feelers are beside it.
    Cylinder(Cylinder),
    /// With the plain cylinder around it.
    Knurled(Box<KnurledCylinder>, Cylinder),
    Other(SharedShape),
}

impl Shape {
    /// The shape that `config` describes; files are relative to `folder`.
    ///
    /// # Errors
    /// When a file cannot be read or holds no shape.
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
                    expected: "corners that do not lie in one plane",
                })?)
            }
            ShapeConfig::Mesh { file, scale } => {
                let TriangleMesh {
                    vertices,
                    triangles,
                } = mesh(folder, file, *scale)?;
                // The flags that tell inside from outside.
                let mesh = SharedShape::trimesh_with_flags(
                    vertices,
                    triangles,
                    TriMeshFlags::ORIENTED | TriMeshFlags::FIX_INTERNAL_EDGES,
                );
                Form::Other(mesh.map_err(|_| ShapeError::Unfit {
                    file: file.clone(),
                    expected: "a mesh in which every edge joins two triangles",
                })?)
            }
        };
        Ok(Self { form })
    }

    /// The surface point nearest to `point` (m, shape's frame), or `None` when `point` lies on the
    /// surface to within rounding, where the direction to it tells no normal.
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

    /// The side that feelers touch, where the shape is a plain cylinder.
    pub(super) fn side(&self) -> Option<Side> {
        match &self.form {
            Form::Cylinder(cylinder) => Some(Side::of(cylinder)),
            Form::Knurled(..) | Form::Other(_) => None,
        }
    }

    /// What the rigid-body library collides, and its pose in the shape's frame. Knurls are left
    /// out: a knurled cylinder collides as a plain one.
    pub fn collider(&self) -> (SharedShape, LibraryPose) {
        // The library's cylinders stand along y, ours along z.
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

    /// Mass, centre of mass and inertia at `density`, kg/m³, in the shape's frame.
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        let (shape, pose) = self.collider();
        shape.mass_properties(density).transform_by(&pose)
    }

    /// Half the size of the box around the shape in its frame, m, and that box's centre; `None` for
    /// a half-space.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let (shape, pose) = self.collider();
        let bounds = shape.compute_aabb(&pose);
        let half = bounds.half_extents();
        (half.max_element() < 1e6).then(|| (half, bounds.center()))
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
    fn a_half_space_has_no_bounds_and_the_rest_has() {
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
