//! Parameters of shapes in an experiment file.

use feeler::check::Checker;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Maximum number of knurls; far finer ones than a feeler can resolve.
const MAX_KNURLS: u32 = 10_000;

/// Maximum number of a section's corners; rounding replaces each by hundreds.
const MAX_CORNERS: usize = 32;

/// A shape in an experiment file. Lengths are in metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ShapeConfig {
    /// An upright cylinder.
    Cylinder {
        /// Radius (m).
        radius: f64,
        /// Height (m).
        height: f64,
    },
    /// An upright cylinder with a knurled or oval side.
    KnurledCylinder {
        /// Radius at the crests (m).
        radius: f64,
        /// Height (m).
        height: f64,
        /// Number of knurls.
        knurls: u32,
        /// Depth of the grooves (m).
        depth: f64,
        /// Relative increase of the radius along x and decrease along y.
        #[serde(default)]
        ovality: f64,
    },
    /// An upright cylinder with an elliptic section.
    EllipticCylinder {
        /// Semi-axes along x and y (m).
        semi_axes: [f64; 2],
        /// Height (m).
        height: f64,
    },
    /// An upright prism with a convex section and rounded edges.
    RoundedPrism {
        /// Corners (x, y) whose convex hull is the section before rounding (m).
        corners: Vec<[f64; 2]>,
        /// Radius of the edges: distance by which the hull is grown (m).
        rounding: f64,
        /// Height (m).
        height: f64,
    },
    /// A cuboid.
    Box {
        /// Lengths along x, y and z (m).
        size: [f64; 3],
    },
    /// A sphere.
    Sphere {
        /// Radius (m).
        radius: f64,
    },
    /// An upright cylinder with hemispherical ends.
    Capsule {
        /// Radius (m).
        radius: f64,
        /// Distance between the hemispheres' centres (m).
        length: f64,
    },
    /// The half-space below z = 0, such as a table or a wall.
    HalfSpace,
    /// The convex hull of a mesh.
    ConvexHull {
        /// STL or OBJ file, relative to the experiment's folder.
        file: PathBuf,
        /// Metres per unit of the file.
        #[serde(default = "one")]
        scale: f64,
    },
    /// A closed triangle mesh.
    Mesh {
        /// STL or OBJ file, relative to the experiment's folder.
        file: PathBuf,
        /// Metres per unit of the file.
        #[serde(default = "one")]
        scale: f64,
    },
}

fn one() -> f64 {
    1.0
}

impl ShapeConfig {
    /// Checks that every value of the shape at `key` is in its range. Files are checked when they are read.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let mut size = |kind: &str, fields: &[(&str, f64)]| {
            for (field, value) in fields {
                checker.between(&format!("{key}.{kind}.{field}"), *value, 1e-6, 10.0);
            }
        };
        match *self {
            Self::Cylinder { radius, height } => {
                size("cylinder", &[("radius", radius), ("height", height)]);
            }
            Self::KnurledCylinder {
                radius,
                height,
                knurls,
                depth,
                ovality,
            } => {
                size(
                    "knurled_cylinder",
                    &[("radius", radius), ("height", height)],
                );
                let key = format!("{key}.knurled_cylinder");
                checker.between(&format!("{key}.depth"), depth, 0.0, 0.2 * radius);
                checker.between(&format!("{key}.ovality"), ovality, -0.3, 0.3);
                checker.require(
                    &format!("{key}.knurls"),
                    knurls.to_string(),
                    knurls <= MAX_KNURLS,
                    &format!("0 to {MAX_KNURLS}"),
                );
            }
            Self::EllipticCylinder {
                semi_axes: [x, y],
                height,
            } => {
                let fields = [("semi_axes.x", x), ("semi_axes.y", y), ("height", height)];
                size("elliptic_cylinder", &fields);
            }
            Self::RoundedPrism {
                ref corners,
                rounding,
                height,
            } => {
                size(
                    "rounded_prism",
                    &[("rounding", rounding), ("height", height)],
                );
                checker.require(
                    &format!("{key}.rounded_prism.corners"),
                    format!("{} corners", corners.len()),
                    (1..=MAX_CORNERS).contains(&corners.len())
                        && corners.iter().flatten().all(|c| c.abs() <= 10.0),
                    &format!("1 to {MAX_CORNERS} corners, each of two numbers from -10 to 10"),
                );
            }
            Self::Box { size: [x, y, z] } => {
                size("box", &[("size.x", x), ("size.y", y), ("size.z", z)]);
            }
            Self::Sphere { radius } => size("sphere", &[("radius", radius)]),
            Self::Capsule { radius, length } => {
                size("capsule", &[("radius", radius), ("length", length)]);
            }
            Self::HalfSpace => {}
            Self::ConvexHull { scale, .. } => size("convex_hull", &[("scale", scale)]),
            Self::Mesh { scale, .. } => size("mesh", &[("scale", scale)]),
        }
    }
}
