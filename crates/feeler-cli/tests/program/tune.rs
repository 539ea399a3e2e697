//! `feeler tune`.

use crate::program::{document, experiment, folder, run};
use std::fs;
use std::path::Path;

/// Identified values for `my.toml`, the same for both fingers.
fn identified() -> String {
    let estimate = |key: &str, value: f64, half: f64| {
        let (low, high) = (value - half, value + half);
        format!(
            "{key} = {{ value = {value:?}, low = {low:?}, high = {high:?}, method = \"given\" }}\n"
        )
    };
    let object = ["pivot_x", "pivot_y"]
        .map(|key| estimate(key, 0.0, 0.0005))
        .concat();
    let finger = [
        estimate("force_noise", 0.002, 0.0002),
        estimate("normal_stiffness", 205.0, 10.0),
        estimate("shear_stiffness", 127.0, 6.0),
        estimate("hysteresis", 0.1, 0.05),
        estimate("static_friction", 1.14, 0.03),
        estimate("kinetic_friction", 0.78, 0.03),
        estimate("servo_lag", 0.0125, 0.002),
        estimate("dead_time", 0.01, 0.005),
    ]
    .concat();
    let radius = estimate("radius", 0.014, 0.0007);
    format!(
        "experiment = \"cap-closing\"\nseed = 0\n[object]\n{object}{radius}[[finger]]\n{finger}[[finger]]\n{finger}"
    )
}

/// Writes `my.toml` and `identified.toml` to a new folder.
fn prepared(name: &str) -> std::path::PathBuf {
    let folder = folder(name);
    experiment(&folder, "seed = 0", "seed = 0");
    fs::write(folder.join("identified.toml"), identified()).unwrap();
    folder
}

fn tune<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["tune", "my.toml", "--identified=identified.toml"], more].concat()
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn tuned_file_differs_only_in_tuned_values_and_is_valid() {
    let folder = prepared("tune");
    let said = run(&folder, &tune(&["-o=tuned.toml"])).done();
    assert!(said.contains("predicted success: "), "{said}");
    let (before, after) = (read(&folder, "my.toml"), read(&folder, "tuned.toml"));
    assert_eq!(before.lines().count(), after.lines().count());
    let differing = before.lines().zip(after.lines()).filter(|(a, b)| a != b);
    for (_, after) in differing {
        assert!(after.contains("; tuned by rule: "), "{after}");
    }
    run(&folder, &["check", "tuned.toml"]).done();
    let page = document(&folder.join("tuned.html"));
    for word in [
        "predicted success",
        "control.slip_threshold",
        "pivot y",
        "path-is-curved",
    ] {
        assert!(page.contains(word), "{word}");
    }
    run(&folder, &tune(&["-o=tuned.toml"])).refused(&["exists already"]);
    run(&folder, &tune(&["-o=my.toml", "--force"])).refused(&["an input"]);
}

#[test]
fn search_with_a_fixed_number_of_runs_is_reproducible() {
    let folder = prepared("tune-search");
    run(
        &folder,
        &tune(&["--evaluations=240", "--jobs=1", "-o=one.toml"]),
    )
    .done();
    run(
        &folder,
        &tune(&["--evaluations=240", "--jobs=2", "-o=two.toml"]),
    )
    .done();
    for kind in ["toml", "html"] {
        let [one, two] = ["one", "two"].map(|name| read(&folder, &format!("{name}.{kind}")));
        assert!(one == two, "{kind}");
    }
}

#[test]
fn invalid_input_is_refused() {
    let folder = prepared("tune-bad");
    let refused = |identified: &str, words: &[&str]| {
        fs::write(folder.join("bad.toml"), identified).unwrap();
        let arguments = ["tune", "my.toml", "--identified=bad.toml", "-o=tuned.toml"];
        run(&folder, &arguments).refused(words);
        assert!(!folder.join("tuned.toml").exists());
    };
    let good = identified();
    refused(
        &good.replacen("value = 205.0", "value = -205.0", 1),
        &[
            "bad.toml",
            "finger[0].normal_stiffness.value = -205",
            "expected 10 to",
        ],
    );
    refused(
        &good.replacen("low = 195.0", "low = 210.0", 1),
        &["finger[0].normal_stiffness", "low <= 205 <= high"],
    );
    let slippery = |line: &str| match line.starts_with("kinetic_friction") {
        true => {
            "kinetic_friction = { value = 1.5, low = 1.4, high = 1.6, method = \"given\" }\n".into()
        }
        false => format!("{line}\n"),
    };
    refused(
        &good.lines().map(slippery).collect::<String>(),
        &[
            "finger[0].kinetic_friction.value = 1.5",
            "at most static_friction",
        ],
    );
    refused(
        &good.replace("\"cap-closing\"", "\"contour\""),
        &[
            "\"contour\"",
            "expected values of the experiment \"cap-closing\"",
        ],
    );
    let one = good.rsplit_once("[[finger]]").unwrap().0;
    refused(one, &["expected values of 2 fingers", "got 1"]);
    refused("seed = 1", &["bad.toml", "experiment"]);
    let good = "--identified=identified.toml";
    run(
        &folder,
        &["tune", "my.toml", "--identified=none.toml", "-o=t.toml"],
    )
    .refused(&["none.toml", "expected the identified values"]);
    run(
        &folder,
        &["tune", "my.toml", good, "--search=0", "-o=t.toml"],
    )
    .refused(&["above 0 s"]);
    run(&folder, &["tune", "my.toml", good, "-o=t.html"]).refused(&["ends in .toml"]);
    let contour = identified().replace("\"cap-closing\"", "\"contour\"");
    let one = contour.rsplit_once("[[finger]]").unwrap().0;
    fs::write(folder.join("contour.toml"), one).unwrap();
    run(
        &folder,
        &["tune", "contour", "--identified=contour.toml", "-o=t.toml"],
    )
    .refused(&["got task.contour", "[task.screw]"]);
}
