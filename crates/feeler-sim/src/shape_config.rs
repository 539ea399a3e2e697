//! Shapes, as an experiment file describes them.

use feeler::check::Checker;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Most knurls around a cylinder: finer ones than a feeler could ever feel.
const MAX_KNURLS: u32 = 10_000;

/// Most corners of a section: each becomes hundreds when it is rounded.
const MAX_CORNERS: usize = 32;

/// A shape, as an experiment file describes it. Lengths in metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ShapeConfig {
    /// An upright cylinder.
    Cylinder {
        /// Radius, m.
        radius: f64,
        /// Height, m.
        height: f64,
    },
    /// An upright cylinder with knurls along its side, or an oval one, or both.
    KnurledCylinder {
        /// Radius at the crests, m.
        radius: f64,
        /// Height, m.
        height: f64,
        /// Knurls around the side.
        knurls: u32,
        /// From crest to groove, m.
        depth: f64,
        /// Relative excess of the radius along x, and lack of it along y.
        #[serde(default)]
        ovality: f64,
    },
    /// An upright cylinder whose section is an ellipse.
    EllipticCylinder {
        /// Semi-axes along x and y, m.
        semi_axes: [f64; 2],
        /// Height, m.
        height: f64,
    },
    /// An upright prism with a convex section and rounded edges.
    RoundedPrism {
        /// The section's corners before they are rounded, x and y, m: their hull.
        corners: Vec<[f64; 2]>,
        /// Everything within this distance of the hull belongs to the section, m.
        rounding: f64,
        /// Height, m.
        height: f64,
    },
    /// A box.
    Box {
        /// Lengths along x, y and z, m.
        size: [f64; 3],
    },
    /// A sphere.
    Sphere {
        /// Radius, m.
        radius: f64,
    },
    /// An upright cylinder with half a sphere at either end.
    Capsule {
        /// Radius, m.
        radius: f64,
        /// Distance of the spheres' centres, m.
        length: f64,
    },
    /// Everything below z = 0: a table, a wall.
    HalfSpace,
    /// The convex hull of a mesh's corners.
    ConvexHull {
        /// STL or OBJ file, relative to the experiment's.
        file: PathBuf,
        /// Metres per unit of the file.
        #[serde(default = "one")]
        scale: f64,
    },
    /// A closed triangle mesh.
    Mesh {
        /// STL or OBJ file, relative to the experiment's.
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
    /// Requires every value of the shape at `key` to be in its range. Files are looked at when they are read.
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
