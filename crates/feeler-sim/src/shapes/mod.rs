//! Shapes of objects and distances to their surfaces.

pub(crate) mod knurled_cylinder;
pub(crate) mod mesh_file;
pub(crate) mod prism;
pub(crate) mod section;
pub mod shape;
pub(crate) mod shape_config;
pub(crate) mod surface_point;

pub use knurled_cylinder::KnurledCylinder;
pub use mesh_file::{MeshError, TriangleMesh, read_mesh};
pub use section::section;
pub use shape::{Shape, ShapeConfig};
