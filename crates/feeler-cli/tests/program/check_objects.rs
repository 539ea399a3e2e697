//! Checks of objects by `feeler check`.

use crate::program::{folder, run};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Writes an OBJ file of a cube of edge length `side`, in any unit, without its last `missing` triangles.
fn cube(path: &Path, side: f64, missing: usize) {
    let mut text = String::new();
    for corner in 0..8 {
        let coordinate = |axis: i32| side * (f64::from(corner >> axis & 1) - 0.5);
        let (x, y, z) = (coordinate(0), coordinate(1), coordinate(2));
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    let faces = [
        [1, 3, 4],
        [1, 4, 2],
        [5, 6, 8],
        [5, 8, 7],
        [1, 2, 6],
        [1, 6, 5],
        [3, 7, 8],
        [3, 8, 4],
        [1, 5, 7],
        [1, 7, 3],
        [2, 4, 8],
        [2, 8, 6],
    ];
    for [a, b, c] in &faces[..faces.len() - missing] {
        writeln!(text, "f {a} {b} {c}").unwrap();
    }
    fs::write(path, text).unwrap();
}

/// Writes the reference experiment with an additional object to `folder`.
fn with_object(folder: &Path, object: &str) {
    crate::program::experiment(
        folder,
        "[sim.torque_sensor]",
        &format!("[sim.object.part]\n{object}\n\n[sim.torque_sensor]"),
    );
}

/// A fixed mesh from `file` at `scale`.
fn mesh(file: &str, scale: f64) -> String {
    format!(
        "shape.mesh = {{ file = \"{file}\", scale = {scale:?} }}\nmotion = \"fixed\"\n\
         position = [0.0, 0.4, 0.1]"
    )
}

#[test]
fn mesh_in_a_wrong_unit_causes_a_warning_or_an_error() {
    let folder = folder("check-millimetres");
    cube(&folder.join("cube.obj"), 20.0, 0);
    // Within the permitted size of an object, but beyond links of 30, 60 and 55 mm and a dome of 18 mm.
    with_object(&folder, &mesh("cube.obj", 0.01));
    let warned = run(&folder, &["check", "my.toml"]).done();
    let words = [
        "warning: sim.object.part: 0.200 m",
        "reaches 0.163 m",
        "scale = 0.001",
        "good",
    ];
    for word in words {
        assert!(warned.contains(word), "{warned}");
    }
    with_object(&folder, &mesh("cube.obj", 1.0));
    run(&folder, &["check", "my.toml"]).refused(&["sim.object.part", "20 m", "0.001"]);
    with_object(&folder, &mesh("cube.obj", 0.001));
    let good = run(&folder, &["check", "my.toml"]).done();
    assert!(!good.contains("warning") && good.contains("good"), "{good}");
}

#[test]
fn large_free_objects_cause_a_warning_but_fixed_ones_do_not() {
    let folder = folder("check-large");
    let table = "shape.box = { size = [1.0, 1.0, 0.02] }\nposition = [0.0, 0.0, 0.0]\nmotion = ";
    with_object(&folder, &format!("{table}\"fixed\""));
    let good = run(&folder, &["check", "my.toml"]).done();
    assert!(!good.contains("warning"), "{good}");
    with_object(&folder, &format!("{table}{{ free = {{}} }}"));
    let warned = run(&folder, &["check", "my.toml"]).done();
    assert!(
        warned.contains("warning: sim.object.part: 1.000 m"),
        "{warned}"
    );
    assert!(
        !warned.contains("scale") && warned.contains("good"),
        "{warned}"
    );
}

#[test]
fn invalid_objects_are_refused_before_the_run() {
    let folder = folder("check-refused");
    cube(&folder.join("open.obj"), 20.0, 1);
    let free = "shape.sphere = { radius = 0.01 }\nmotion = { free = {} }\nposition = ";
    let cases: [(String, &[&str]); 4] = [
        (
            mesh("nowhere.obj", 0.001),
            &["sim.object.part.shape", "nowhere.obj"],
        ),
        (
            mesh("open.obj", 0.001),
            &["sim.object.part.shape", "open.obj"],
        ),
        (
            format!("{free}[0.0, 0.0, 0.105]"),
            &["sim.object.", "deep in sim.object.part"],
        ),
        (
            format!("{free}[-0.03, 0.0, 0.1]"),
            &["sim.object.part", "element", "starts"],
        ),
    ];
    for (object, words) in cases {
        with_object(&folder, &object);
        run(&folder, &["check", "my.toml"]).refused(words);
    }
}
