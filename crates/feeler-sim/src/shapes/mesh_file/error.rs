//! Errors of mesh files.

use glam::DVec3;
use std::io::Error;

/// Error when reading a mesh file.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The file name has no known extension.
    #[error("expected the extension .stl or .obj, got {0:?}")]
    Extension(String),
    /// The scale is not positive.
    #[error("expected a scale above 0 (m per unit of the file), got {0}")]
    Scale(f64),
    /// Reading the file failed.
    #[error("failed to read the mesh: {0}")]
    Read(#[from] Error),
    /// The file is too long.
    #[error("the mesh file is longer than {most} bytes", most = super::MAX_BYTES)]
    TooLong,
    /// The length of a binary STL contradicts its header.
    #[error(
        "expected a binary STL of {expected} bytes for the {claimed} triangles of its header, got {bytes} bytes"
    )]
    Length {
        /// Number of triangles in the header.
        claimed: u32,
        /// Length of a file with that number of triangles (bytes).
        expected: u64,
        /// Length of the file (bytes).
        bytes: usize,
    },
    /// The STL file is invalid.
    #[error("invalid STL file: {0}")]
    Stl(String),
    /// The OBJ file is invalid.
    #[error("invalid OBJ file: {0}")]
    Obj(#[from] tobj::LoadError),
    /// A coordinate is infinite or NaN.
    #[error("expected finite coordinates, got a corner of triangle {triangle} at {corner} m")]
    NotFinite {
        /// Number of the triangle, from 1.
        triangle: usize,
        /// Position of the corner (m).
        corner: DVec3,
    },
    /// The mesh has too few triangles for a solid, or too many.
    #[error("expected 4 to {most} triangles, got {0}", most = super::MAX_TRIANGLES)]
    Count(usize),
    /// The mesh is too small or too large for an object that a hand touches.
    #[error(
        "expected a mesh of {least} to {most} m, got {0} m; check its scale (0.001 for millimetres)",
        least = super::check::SIZES[0],
        most = super::check::SIZES[1]
    )]
    Size(f64),
    /// A triangle has zero area.
    #[error(
        "triangle {triangle} has zero area; its corners are {}, {}, {} m",
        .corners[0], .corners[1], .corners[2]
    )]
    Degenerate {
        /// Number of the triangle, from 1.
        triangle: usize,
        /// Corners (m).
        corners: [DVec3; 3],
    },
    /// The surface has holes.
    #[error(
        "the surface is not closed: {count} edges belong to one triangle alone, such as that from {from} to {to} m"
    )]
    Open {
        /// Number of edges with only one triangle.
        count: usize,
        /// Start of the first such edge (m).
        from: DVec3,
        /// End of that edge (m).
        to: DVec3,
    },
    /// Adjacent triangles have opposite orientations, or more than two triangles share an edge.
    #[error(
        "expected two triangles of the same orientation at each edge; {count} edges have more or opposite ones, such as that from {from} to {to} m"
    )]
    Orientation {
        /// Number of such edges.
        count: usize,
        /// Start of the first such edge (m).
        from: DVec3,
        /// End of that edge (m).
        to: DVec3,
    },
    /// The enclosed volume is zero.
    #[error("the surface encloses no volume ({0} m^3)")]
    Volume(f64),
}
