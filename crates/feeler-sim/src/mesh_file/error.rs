//! Why a file gives no mesh.

use glam::DVec3;
use std::io::Error;

/// Why a file gives no mesh.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The file's name does not say what it is.
    #[error("a mesh file named .stl or .obj expected, its extension is {0:?}")]
    Extension(String),
    /// The scale cannot be used.
    #[error("a scale above 0 expected, m per unit of the file; it is {0}")]
    Scale(f64),
    /// The file cannot be read.
    #[error("a readable mesh file expected: {0}")]
    Read(#[from] Error),
    /// The file is too long.
    #[error("a mesh file of at most {most} bytes expected, it has more", most = super::MAX_BYTES)]
    TooLong,
    /// A binary STL does not hold what its header says.
    #[error(
        "a binary STL of {claimed} triangles, as its header says, has {expected} bytes; the file has {bytes}"
    )]
    Length {
        /// Triangles by the header.
        claimed: u32,
        /// Bytes of a file with so many.
        expected: u64,
        /// Bytes of the file.
        bytes: usize,
    },
    /// The file is no STL.
    #[error("an STL file expected: {0}")]
    Stl(String),
    /// The file is no OBJ.
    #[error("an OBJ file expected: {0}")]
    Obj(#[from] tobj::LoadError),
    /// A coordinate is infinite or not a number.
    #[error("finite coordinates expected; triangle {triangle} has a corner at {corner} m")]
    NotFinite {
        /// The triangle, from 1.
        triangle: usize,
        /// Its corner, m.
        corner: DVec3,
    },
    /// Too few triangles for a solid, or too many for a mesh of this program.
    #[error("from 4 to {most} triangles expected, the file has {0}", most = super::MAX_TRIANGLES)]
    Count(usize),
    /// The mesh has the size of no object that a hand touches.
    #[error(
        "an object of {least} to {most} m expected, the mesh is {0} m long; is its scale right (0.001 for millimetres)?",
        least = super::check::SIZES[0],
        most = super::check::SIZES[1]
    )]
    Size(f64),
    /// A triangle has no area.
    #[error(
        "triangles with an area expected; triangle {triangle} has none, its corners are {}, {}, {} m",
        .corners[0], .corners[1], .corners[2]
    )]
    Degenerate {
        /// The triangle, from 1.
        triangle: usize,
        /// Its corners, m.
        corners: [DVec3; 3],
    },
    /// The surface has holes.
    #[error(
        "a closed surface expected: {count} edges belong to one triangle alone, one of them from {from} to {to} m"
    )]
    Open {
        /// Edges of one triangle.
        count: usize,
        /// Where one of them begins, m.
        from: DVec3,
        /// Where it ends, m.
        to: DVec3,
    },
    /// Neighbours are oriented against each other, or more than two triangles meet in an edge.
    #[error(
        "two triangles of the same orientation expected at each edge: {count} edges have more or disagreeing ones, one of them from {from} to {to} m"
    )]
    Orientation {
        /// Such edges.
        count: usize,
        /// Where one of them begins, m.
        from: DVec3,
        /// Where it ends, m.
        to: DVec3,
    },
    /// The surface encloses nothing.
    #[error("a surface around a volume expected, it encloses {0} m^3")]
    Volume(f64),
}
