//! Reads closed triangle meshes from STL and OBJ files, and validates them.

mod check;
mod error;

pub use error::MeshError;

use glam::DVec3;
use std::collections::HashMap;
use std::io::{Cursor, Error, Read};
use std::path::Path;

/// Maximum size of a file (bytes); about that of a text STL with 1 million triangles.
const MAX_BYTES: u64 = 256 << 20;
/// Maximum number of triangles.
const MAX_TRIANGLES: usize = 1_000_000;
/// Size of the header of a binary STL, including the number of triangles (bytes).
const STL_HEADER: usize = 84;
/// Size of a triangle of a binary STL (bytes).
const STL_TRIANGLE: usize = 50;

/// A closed, consistently oriented surface.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleMesh {
    /// Unique vertices in the object's frame (m).
    pub vertices: Vec<DVec3>,
    /// Vertex indices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Reads a mesh from the STL (binary or text) or OBJ file at `path`, depending on its extension. `scale` is in metres
/// per unit of the file.
///
/// Merges vertices at the same position and triangulates polygons as fans. Flips the orientation if normals point
/// inward. Self-intersections are not detected.
pub fn read_mesh(path: &Path, scale: f64) -> Result<TriangleMesh, MeshError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let corners = match extension.to_ascii_lowercase().as_str() {
        "stl" => stl_corners,
        "obj" => obj_corners,
        _ => return Err(MeshError::Extension(extension.into_owned())),
    };
    if !(scale.is_finite() && scale > 0.0) {
        return Err(MeshError::Scale(scale));
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path)?
        .take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(MeshError::TooLong);
    }
    let mut mesh = merged(&corners(bytes)?, scale)?;
    check::size(&mesh)?;
    check::areas(&mesh)?;
    check::edges(&mesh)?;
    check::turn_outward(&mut mesh)?;
    Ok(mesh)
}

impl TriangleMesh {
    /// Enclosed volume (m^3); negative if triangles are clockwise seen from outside.
    pub fn signed_volume(&self) -> f64 {
        // Tetrahedra with an apex on the mesh limit cancellation if the mesh is far from the origin.
        let apex = self.vertices.first().copied().unwrap_or_default();
        let volume = |t: &[u32; 3]| {
            let [a, b, c] = self.corners(t).map(|p| p - apex);
            a.dot(b.cross(c)) / 6.0
        };
        self.triangles.iter().map(volume).sum()
    }

    /// Longest side of the bounding box (m).
    pub fn size(&self) -> f64 {
        let first = self.vertices.first().copied().unwrap_or_default();
        let low = self.vertices.iter().fold(first, |low, p| low.min(*p));
        let high = self.vertices.iter().fold(first, |high, p| high.max(*p));
        (high - low).max_element()
    }

    fn corners(&self, triangle: &[u32; 3]) -> [DVec3; 3] {
        triangle.map(|v| self.vertices[v as usize])
    }
}

/// Corners of all triangles of an STL file, three per triangle, in the file's unit.
fn stl_corners(mut bytes: Vec<u8>) -> Result<Vec<DVec3>, MeshError> {
    let text = bytes.trim_ascii_start().starts_with(b"solid") && !bytes.contains(&0);
    let facets = if text {
        // stl_io requires one solid, a space after its first word, UTF-8 and lower case.
        let all = String::from_utf8_lossy(&bytes).to_ascii_lowercase();
        let rest = all.trim_start().split_once('\n').unwrap_or_default().1;
        bytes = format!("solid \n{rest}").into_bytes();
        let ends = |line: &&str| line.trim_start().starts_with("endfacet");
        rest.lines().filter(ends).count()
    } else {
        let claimed = binary_count(&bytes)?;
        // stl_io would parse a file with the header "solid" as text.
        bytes[..STL_HEADER - 4].fill(0);
        claimed
    };
    check::count(facets)?;
    let fault = |e: Error| MeshError::Stl(e.to_string());
    let mut corners = Vec::with_capacity(3 * facets);
    for triangle in stl_io::create_stl_reader(&mut Cursor::new(bytes)).map_err(fault)? {
        let vertices = triangle.map_err(fault)?.vertices;
        corners.extend(vertices.map(|v| DVec3::from_array(v.0.map(f64::from))));
    }
    if corners.len() != 3 * facets {
        let read = corners.len() / 3;
        let reason = format!("expected one solid with {facets} facets, got {read} facets");
        return Err(MeshError::Stl(reason));
    }
    Ok(corners)
}

/// Number of triangles of a binary STL, if the file has the length that its header requires.
fn binary_count(bytes: &[u8]) -> Result<usize, MeshError> {
    let header = bytes.first_chunk::<STL_HEADER>();
    let Some(count) = header.and_then(|h| h.last_chunk::<4>()) else {
        let reason = format!(
            "expected the word solid or at least {STL_HEADER} bytes, got {} bytes",
            bytes.len()
        );
        return Err(MeshError::Stl(reason));
    };
    let claimed = u32::from_le_bytes(*count);
    let expected = STL_HEADER as u64 + u64::from(claimed) * STL_TRIANGLE as u64;
    if expected != bytes.len() as u64 {
        return Err(MeshError::Length {
            claimed,
            expected,
            bytes: bytes.len(),
        });
    }
    Ok(claimed as usize)
}

/// Corners of all triangles of an OBJ file, three per triangle, in the file's unit.
fn obj_corners(bytes: Vec<u8>) -> Result<Vec<DVec3>, MeshError> {
    let text = String::from_utf8_lossy(&bytes)
        .replace("\r\n", "\n")
        .replace("\\\n", " ");
    // Checked before allocation, as a short text can define many triangles.
    check::count_at_most(text.lines().map(triangles_of_line).sum())?;
    let mut shape = String::new();
    text.lines().for_each(|line| keep_shape(line, &mut shape));
    let options = tobj::LoadOptions {
        triangulate: true,
        single_index: true,
        ..Default::default()
    };
    let no_material = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut shape.as_bytes(), &options, no_material)?;
    let mut corners = Vec::new();
    for mesh in models.iter().map(|m| &m.mesh) {
        let (points, _) = mesh.positions.as_chunks::<3>();
        let corner = |&i: &u32| points.get(i as usize).map(|p| DVec3::from_array(*p));
        corners.extend(mesh.indices.iter().filter_map(corner));
    }
    Ok(corners)
}

fn words(line: &str) -> impl Iterator<Item = &str> + Clone {
    let code = line.split('#').next().unwrap_or_default();
    code.split_whitespace()
}

/// Number of triangles that a line of an OBJ file defines; at least one for a face.
fn triangles_of_line(line: &str) -> usize {
    let mut words = words(line);
    match words.next() {
        Some("f") => words.count().saturating_sub(2).max(1),
        _ => 0,
    }
}

/// Appends a line of an OBJ file to `shape`, without colours, texture coordinates and normals, on which tobj could fail
/// in a malicious file.
fn keep_shape(line: &str, shape: &mut String) {
    let mut words = words(line);
    let Some(kind @ ("v" | "f")) = words.next() else {
        return;
    };
    // A vertex has three coordinates, optionally followed by a weight or by three colour components.
    let coloured = kind == "v" && words.clone().take(5).count() > 4;
    let kept = if coloured { 3 } else { usize::MAX };
    shape.push_str(kind);
    for word in words.take(kept) {
        let position = word.split('/').next().filter(|p| !p.is_empty());
        shape.push(' ');
        shape.push_str(position.unwrap_or(word));
    }
    shape.push('\n');
}

/// Builds a mesh from three corners per triangle and merges equal corners.
fn merged(corners: &[DVec3], scale: f64) -> Result<TriangleMesh, MeshError> {
    let (triangles, _) = corners.as_chunks::<3>();
    check::count(triangles.len())?;
    let mut index_of = HashMap::new();
    let mut mesh = TriangleMesh {
        vertices: Vec::new(),
        triangles: Vec::new(),
    };
    for (index, triangle) in triangles.iter().enumerate() {
        let mut of_triangle = [0; 3];
        for (index_there, corner) in of_triangle.iter_mut().zip(triangle) {
            // Adding zero turns -0 into 0.
            let corner = scale * corner + DVec3::ZERO;
            if !corner.is_finite() {
                return Err(MeshError::NotFinite {
                    triangle: index + 1,
                    corner,
                });
            }
            let vertices = &mut mesh.vertices;
            *index_there = *index_of
                .entry(corner.to_array().map(f64::to_bits))
                .or_insert_with(|| {
                    vertices.push(corner);
                    vertices.len() as u32 - 1
                });
        }
        mesh.triangles.push(of_triangle);
    }
    Ok(mesh)
}
