//! The contour task: outlines of unknown objects, compared with their true sections.

use crate::program::{folder, part, run, summary};
use serde_json::Value;
use std::path::Path;

/// The box of the experiment. Parameters were chosen for it and for the cylinder; the other shapes are new.
const BOX: &str = "{ box = { size = [0.030, 0.020, 0.040] } }";
const CYLINDER: &str = "{ cylinder = { radius = 0.014, height = 0.040 } }";
const ELLIPSE: &str = "{ elliptic_cylinder = { semi_axes = [0.017, 0.010], height = 0.040 } }";
const TRIANGLE: &str = "{ rounded_prism = { corners = [[0.012, 0.0], [-0.008, 0.012], \
    [-0.008, -0.012]], rounding = 0.004, height = 0.040 } }";

/// Draws the outline of `shape`, rotated by `angle` (deg), and returns the `summary.json` of the run.
fn draw(folder: &Path, name: &str, shape: &str, angle: u32, more: &[&str]) -> Value {
    let shape = format!("sim.object.specimen.shape={shape}");
    let orientation = format!("sim.object.specimen.orientation_deg=[0, 0, {angle}]");
    let mut arguments = vec!["run", "contour", "--out", name];
    arguments.extend(["--set", &shape, "--set", &orientation]);
    arguments.extend(more);
    run(folder, &arguments).done();
    summary(&folder.join(name))
}

/// Asserts the requirements of the task: an RMS error of 0.5 mm, all corners, no contact lost for more than 100 ms.
fn assert_drawn(summary: &Value, corners: f64, what: &str) {
    assert_eq!(summary["outcome"], "closed", "{what}");
    let error = part(summary, "RMS error");
    assert!(error <= 0.5, "{what}: {error} mm");
    assert_eq!(part(summary, "corners passed"), corners, "{what}");
    let lost = part(summary, "longest time without touch");
    assert!(lost <= 0.1, "{what}: {lost} s");
    // An outline of only a part of the section would have no error either.
    let gap = part(summary, "maximum distance of the section from the outline");
    assert!(gap <= 1.5, "{what}: {gap} mm");
}

#[test]
fn outlines_of_known_and_unknown_shapes_match_their_sections() {
    let folder = folder("contour-shapes");
    for (shape, corners) in [(BOX, 4.0), (CYLINDER, 0.0), (ELLIPSE, 0.0), (TRIANGLE, 0.0)] {
        for (seed, angle) in [("0", 20), ("1", 0), ("2", 45), ("3", 71)] {
            let name = format!("{corners}-{}-{seed}", shape.len());
            let more = ["--sensing", "direct", "--seed", seed];
            let summary = draw(&folder, &name, shape, angle, &more);
            assert_drawn(&summary, corners, &format!("{shape} at {angle} degrees"));
        }
    }
}

#[test]
fn outline_is_as_accurate_with_image_sensing() {
    let folder = folder("contour-pictures");
    let summary = draw(&folder, "pictures", BOX, 20, &[]);
    assert_eq!(summary["sensing"], "image");
    assert_drawn(&summary, 4.0, "with image sensing");
}

#[test]
fn friction_is_estimated_while_tracing() {
    let folder = folder("contour-friction");
    for friction in [0.2, 0.6] {
        let setting = format!(
            "sim.object.specimen.friction={{ static_friction = {friction}, kinetic_friction = {friction} }}"
        );
        let more = [
            "--sensing",
            "direct",
            "--set",
            &setting,
            "--set",
            "sim.variation.friction=0.0",
        ];
        let summary = draw(&folder, &format!("friction-{friction}"), CYLINDER, 0, &more);
        let learned = summary["findings"]["friction"].as_f64().unwrap();
        // The force is controlled to within a few percent, which causes an error of the same size.
        assert!(
            (learned - friction).abs() <= 0.1,
            "{learned} for {friction}"
        );
    }
}

#[test]
fn missing_and_unreachable_objects_are_reported() {
    let folder = folder("contour-refused");
    let place = "sim.object.specimen.position=[0.5, 0.0, 0.1]";
    let words = ["sim.object", "reach", "workspace"];
    run(&folder, &["run", "contour", "--set", place]).refused(&words[..2]);
    let home = "task.contour.home=[0.2, 0.0, 0.1]";
    run(&folder, &["run", "contour", "--set", home])
        .refused(&["home of finger 0", "control.limits"]);
    let force = "task.contour.contact_force=0.01";
    run(&folder, &["run", "contour", "--set", force]).refused(&[
        "task.contour.contact_force = 0.01",
        "more than task.contour.touch_force",
    ]);
    // Within reach, but next to the finger's path.
    let beside = "sim.object.specimen.position=[0.0, -0.055, 0.1]";
    let ended = run(
        &folder,
        &[
            "run",
            "contour",
            "--sensing",
            "direct",
            "--out",
            "beside",
            "--set",
            beside,
        ],
    );
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("without a grasp"), "{ended:?}");
}
