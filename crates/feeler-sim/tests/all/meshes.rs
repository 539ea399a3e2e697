//! Meshes from files: a cube in every format, and invalid meshes.

use feeler_sim::shapes::{MeshError, TriangleMesh, read_mesh};
use glam::DVec3;
use proptest::prelude::*;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

/// Corner of a cube of 20 units: bits 0, 1, 2 of the index select x, y, z.
fn corner(index: usize) -> [f32; 3] {
    [0, 1, 2].map(|axis| if index >> axis & 1 == 1 { 20.0 } else { 0.0 })
}

/// Faces of the cube, counter-clockwise seen from outside.
const FACES: [[usize; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

type Triangle = [[f32; 3]; 3];

fn cube() -> Vec<Triangle> {
    let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
    FACES
        .into_iter()
        .flat_map(halves)
        .map(|t| t.map(corner))
        .collect()
}

fn text_stl(triangles: &[Triangle]) -> Vec<u8> {
    let mut text = String::from("solid cube\n");
    for triangle in triangles {
        text += "facet normal 0 0 0\n outer loop\n";
        for [x, y, z] in triangle {
            writeln!(text, "  vertex {x} {y} {z}").unwrap();
        }
        text += " endloop\nendfacet\n";
    }
    (text + "endsolid cube\n").into_bytes()
}

fn binary_stl(triangles: &[Triangle]) -> Vec<u8> {
    // Some programs start a binary file with the keyword of text files.
    let mut bytes = b"solid or not".to_vec();
    bytes.resize(80, 0);
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        let numbers = [0.0; 3]
            .into_iter()
            .chain(triangle.iter().flatten().copied());
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
        bytes.extend([0, 0]);
    }
    bytes
}

fn obj() -> String {
    let mut text = String::from("mtllib none.mtl\no cube\nvn 0 0 1\n");
    for index in 0..8 {
        let [x, y, z] = corner(index);
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for face in FACES {
        let [a, b, c, d] = face.map(|v| v + 1);
        writeln!(text, "f {a}//1 {b}//1 \\\n {c}//1 {d}//1").unwrap();
    }
    text
}

/// Reads `bytes` as a file of `extension` in millimetres.
fn read(extension: &str, bytes: &[u8]) -> Result<TriangleMesh, MeshError> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = format!("feeler-mesh-{}-{count}.{extension}", std::process::id());
    let path: PathBuf = std::env::temp_dir().join(name);
    std::fs::write(&path, bytes).unwrap();
    let mesh = read_mesh(&path, 0.001);
    std::fs::remove_file(&path).unwrap();
    mesh
}

fn assert_is_the_cube(mesh: &TriangleMesh) {
    assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (8, 12));
    assert!(
        (mesh.signed_volume() - 8e-6).abs() < 1e-18,
        "{}",
        mesh.signed_volume()
    );
    assert!(mesh.vertices.contains(&DVec3::splat(0.02)));
}

#[test]
fn a_cube_is_the_same_in_every_format() {
    assert_is_the_cube(&read("stl", &text_stl(&cube())).unwrap());
    assert_is_the_cube(&read("STL", &binary_stl(&cube())).unwrap());
    assert_is_the_cube(&read("obj", obj().as_bytes()).unwrap());
    assert_is_the_cube(&read("obj", obj().replace('\n', "\r\n").as_bytes()).unwrap());
    let upper = String::from_utf8(text_stl(&cube())).unwrap().to_uppercase();
    let nameless = upper.replace("SOLID CUBE", "solid").replace('\n', "\r\n");
    assert_is_the_cube(&read("stl", nameless.as_bytes()).unwrap());
    // Relative indices, a weight and a colour.
    let coloured = obj()
        .replace("v 20 20 20", "v 20 20 20 1 0.5 0.5")
        .replace("v 0 0 0", "v 0 0 0 2");
    let relative = coloured.replace("f 1//1 3//1", "f -8 -6");
    assert_is_the_cube(&read("obj", relative.as_bytes()).unwrap());
}

#[test]
fn an_inside_out_cube_is_corrected() {
    let turned: Vec<_> = cube().into_iter().map(|[a, b, c]| [a, c, b]).collect();
    assert_is_the_cube(&read("stl", &binary_stl(&turned)).unwrap());
}

#[test]
fn an_open_cube_is_rejected_with_one_of_its_edges() {
    let error = read("stl", &text_stl(&cube()[2..])).unwrap_err();
    assert!(matches!(error, MeshError::Open { count: 4, .. }), "{error}");
    assert!(
        error
            .to_string()
            .contains("4 edges belong to one triangle alone"),
        "{error}"
    );
}

#[test]
fn an_inconsistently_oriented_triangle_is_rejected() {
    let mut triangles = cube();
    triangles[5].swap(0, 1);
    let error = read("stl", &text_stl(&triangles)).unwrap_err();
    assert!(
        matches!(error, MeshError::Orientation { count: 3, .. }),
        "{error}"
    );
}

#[test]
fn two_cubes_that_share_an_edge_are_rejected() {
    let moved = cube()
        .into_iter()
        .map(|t| t.map(|[x, y, z]| [x + 20.0, y + 20.0, z]));
    let both: Vec<_> = cube().into_iter().chain(moved).collect();
    let error = read("stl", &binary_stl(&both)).unwrap_err();
    assert!(
        matches!(error, MeshError::Orientation { count: 1, .. }),
        "{error}"
    );
}

#[test]
fn a_degenerate_triangle_is_rejected() {
    let mut triangles = cube();
    triangles.push([[0.0; 3], [10.0; 3], [20.0; 3]]);
    let error = read("stl", &binary_stl(&triangles)).unwrap_err();
    assert!(
        matches!(error, MeshError::Degenerate { triangle: 13, .. }),
        "{error}"
    );
    let error = read("obj", (obj() + "f 1 1 2\n").as_bytes()).unwrap_err();
    assert!(
        matches!(error, MeshError::Degenerate { triangle: 13, .. }),
        "{error}"
    );
    let error = read("obj", (obj() + "f 1 2\n").as_bytes()).unwrap_err();
    assert!(
        matches!(error, MeshError::Degenerate { triangle: 13, .. }),
        "{error}"
    );
}

#[test]
fn non_finite_coordinates_are_rejected() {
    let mut triangles = cube();
    triangles[3][1][2] = f32::NAN;
    let error = read("stl", &binary_stl(&triangles)).unwrap_err();
    assert!(
        matches!(error, MeshError::NotFinite { triangle: 4, .. }),
        "{error}"
    );
    assert!(matches!(
        read("stl", &text_stl(&triangles)),
        Err(MeshError::Stl(_))
    ));
    let infinite = obj().replace("v 20 20 20", "v 20 inf 20");
    assert!(matches!(
        read("obj", infinite.as_bytes()),
        Err(MeshError::NotFinite { .. })
    ));
}

#[test]
fn a_truncated_file_is_rejected() {
    let bytes = binary_stl(&cube());
    let error = read("stl", &bytes[..bytes.len() - 30]).unwrap_err();
    assert!(
        matches!(
            error,
            MeshError::Length {
                claimed: 12,
                expected: 684,
                bytes: 654
            }
        ),
        "{error}"
    );
    let mut claims = bytes.clone();
    claims[80..84].fill(0xff);
    assert!(matches!(
        read("stl", &claims),
        Err(MeshError::Length {
            claimed: u32::MAX,
            ..
        })
    ));
    let text = text_stl(&cube());
    assert!(matches!(
        read("stl", &text[..text.len() - 30]),
        Err(MeshError::Stl(_))
    ));
    let twice = [text.clone(), text].concat();
    assert!(matches!(read("stl", &twice), Err(MeshError::Stl(_))));
}

#[test]
fn meshes_without_plausible_volume_are_rejected() {
    assert!(matches!(
        read("stl", &text_stl(&cube()[..3])),
        Err(MeshError::Count(3))
    ));
    assert!(matches!(read("obj", b""), Err(MeshError::Count(0))));
    let large: Vec<_> = cube()
        .into_iter()
        .map(|t| t.map(|p| p.map(|x| 1000.0 * x)))
        .collect();
    assert!(matches!(read("stl", &binary_stl(&large)), Err(MeshError::Size(size)) if size > 19.0));
    let [a, b, c, d] = [0, 1, 2, 3].map(corner);
    let sheet = [[a, b, c], [b, d, c], [a, d, b], [a, c, d]];
    assert!(matches!(
        read("stl", &text_stl(&sheet)),
        Err(MeshError::Volume(_))
    ));
    let many = obj() + "f" + &" 1".repeat(1_000_010);
    assert!(matches!(
        read("obj", many.as_bytes()),
        Err(MeshError::Count(_))
    ));
    assert!(matches!(read("stl", b"no"), Err(MeshError::Stl(_))));
    assert!(matches!(read("ply", b""), Err(MeshError::Extension(_))));
    let nowhere = std::env::temp_dir().join("feeler-no-such-mesh.stl");
    assert!(matches!(read_mesh(&nowhere, 1.0), Err(MeshError::Read(_))));
    assert!(matches!(
        read_mesh(&nowhere, f64::NAN),
        Err(MeshError::Scale(_))
    ));
}

fn hostile() -> impl Strategy<Value = Vec<u8>> {
    let word = prop_oneof![
        Just("v"),
        Just("f"),
        Just("vt"),
        Just("vn"),
        Just("o"),
        Just("usemtl"),
        Just("mtllib"),
        Just("\n"),
        Just("1"),
        Just("-1"),
        Just("0"),
        Just("1e308"),
        Just("nan"),
        Just("/"),
        Just("1/1/1"),
        Just("//2"),
        Just("#"),
        Just("9223372036854775807"),
        Just("-9223372036854775808"),
        Just("1/-9223372036854775808"),
        Just("\\\n"),
        Just("solid"),
        Just("facet normal 0 0 1\n"),
        Just("outer loop\n"),
        Just("vertex 1 2 3\n"),
        Just("endloop\n"),
        Just("endfacet\n"),
        Just("endsolid"),
    ];
    let words = prop::collection::vec(word, 0..60).prop_map(|w| w.join(" ").into_bytes());
    let bytes = prop::collection::vec(any::<u8>(), 0..400);
    let changed = (
        any::<bool>(),
        prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    );
    let changed = changed.prop_map(|(text, changes)| {
        let mut bytes = if text {
            obj().into_bytes()
        } else {
            binary_stl(&cube())
        };
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        bytes
    });
    prop_oneof![words, bytes, changed]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Accepted meshes enclose a volume; no input panics.
    #[test]
    fn readers_do_not_panic_on_any_bytes(bytes in hostile()) {
        for extension in ["stl", "obj"] {
            if let Ok(mesh) = read(extension, &bytes) {
                prop_assert!(mesh.signed_volume() > 0.0 && mesh.triangles.len() >= 4);
            }
        }
    }
}
