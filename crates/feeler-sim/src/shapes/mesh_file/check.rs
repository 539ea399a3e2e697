//! Checks that triangles form a valid solid.

use super::{MAX_TRIANGLES, MeshError, TriangleMesh};
use glam::DVec3;

/// Minimum and maximum size (m): longest side of the bounding box. A mesh of another size almost always has the wrong
/// unit.
pub const SIZES: [f64; 2] = [0.001, 1.0];
/// Minimum height of a triangle relative to its longest edge, and minimum volume of a mesh relative to the cube of its
/// size. Smaller values may be rounding errors.
const FLAT: f64 = 1e-12;

/// Checks the number of triangles; a solid has at least four.
pub fn count(triangles: usize) -> Result<(), MeshError> {
    if triangles < 4 {
        return Err(MeshError::Count(triangles));
    }
    count_at_most(triangles)
}

/// Checks the number of faces; a face may yield several triangles.
pub fn count_at_most(faces: usize) -> Result<(), MeshError> {
    if faces > MAX_TRIANGLES {
        return Err(MeshError::Count(faces));
    }
    Ok(())
}

pub fn size(mesh: &TriangleMesh) -> Result<(), MeshError> {
    let size = mesh.size();
    if (SIZES[0]..=SIZES[1]).contains(&size) {
        Ok(())
    } else {
        Err(MeshError::Size(size))
    }
}

pub fn areas(mesh: &TriangleMesh) -> Result<(), MeshError> {
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        let corners = mesh.corners(triangle);
        let [a, b, c] = corners;
        let longest = [b - a, c - b, a - c]
            .map(DVec3::length_squared)
            .into_iter()
            .fold(0.0, f64::max);
        if (b - a).cross(c - a).length() <= FLAT * longest {
            return Err(MeshError::Degenerate {
                triangle: index + 1,
                corners,
            });
        }
    }
    Ok(())
}

/// Checks that every edge belongs to two triangles, in opposite directions.
pub fn edges(mesh: &TriangleMesh) -> Result<(), MeshError> {
    let edges = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    // Sorting groups both directions of an edge, ascending first.
    let mut edges: Vec<_> = edges.map(|(a, b)| (a.min(b), a.max(b), a > b)).collect();
    edges.sort_unstable();
    let (mut open, mut wrong) = (Vec::new(), Vec::new());
    for users in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        match users {
            [up, down] if up.2 != down.2 => {}
            [alone] => open.push(alone),
            [first, ..] => wrong.push(first),
            [] => {}
        }
    }
    let ends = |edge: &(u32, u32, bool)| [edge.0, edge.1].map(|v| mesh.vertices[v as usize]);
    if let Some([from, to]) = open.first().map(|e| ends(e)) {
        return Err(MeshError::Open {
            count: open.len(),
            from,
            to,
        });
    }
    if let Some([from, to]) = wrong.first().map(|e| ends(e)) {
        return Err(MeshError::Orientation {
            count: wrong.len(),
            from,
            to,
        });
    }
    Ok(())
}

pub fn turn_outward(mesh: &mut TriangleMesh) -> Result<(), MeshError> {
    let volume = mesh.signed_volume();
    if volume.abs() <= FLAT * mesh.size().powi(3) {
        return Err(MeshError::Volume(volume));
    }
    if volume < 0.0 {
        for triangle in &mut mesh.triangles {
            triangle.swap(1, 2);
        }
    }
    Ok(())
}
