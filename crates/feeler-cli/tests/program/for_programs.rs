//! Output for other programs (JSON, shell completions, manual pages), and the help.

use crate::program::{folder, run};
use serde_json::Value;

/// Parses the single object that a command prints.
fn object(text: &str) -> Value {
    let value: Value = serde_json::from_str(text).expect("one JSON value");
    assert!(value.is_object(), "{value}");
    value
}

#[test]
fn list_and_check_print_json_objects() {
    let folder = folder("json");
    let listed = object(&run(&folder, &["list", "--json"]).done());
    assert_eq!(listed["experiments"][0]["name"], "cap-closing");
    let text = listed["taxels"][0]["description"].as_str();
    assert!(text.is_some_and(|text| text.contains("16 taxels")));
    let checked = object(&run(&folder, &["check", "three-fingers", "--json"]).done());
    assert_eq!(checked["good"], true);
    assert_eq!(checked["elements"], serde_json::json!([41, 41, 41]));
    assert_eq!(
        (&checked["strokes"], &checked["simulated"]),
        (&4.into(), &true.into())
    );
    // Problems are printed on both streams.
    let wrong = [
        "check",
        "cap-closing",
        "--json",
        "--set=control.period=-1",
        "--set=control.touch_force=-2",
    ];
    let ended = run(&folder, &wrong);
    let checked = object(&ended.stdout);
    assert_eq!(checked["good"], false);
    let problems = checked["problems"].as_array().expect("problems");
    assert!(problems.len() >= 2, "{checked}");
    ended.refused(&["control.period = -1", "control.touch_force = -2"]);
    let absent = run(&folder, &["check", "none.toml", "--json"]);
    assert_eq!(
        object(&absent.stdout)["problems"].as_array().map(Vec::len),
        Some(1)
    );
    let cameras = object(&run(&folder, &["cameras", "--json"]).done());
    assert!(cameras["video4linux"]["cameras"].is_array());
    // Without a hand, only the error is printed.
    let stop = run(&folder, &["stop", "no-such-rig", "--json"]);
    assert_eq!((stop.status, stop.stdout.as_str()), (Some(2), ""));
}

#[test]
fn calibrate_locate_and_score_slip_print_json_objects() {
    let folder = folder("json-sensor");
    let loads = [
        "calibrate",
        "--simulated",
        "--loads=30",
        "--write-loads=loads",
        "-o=a.toml",
        "--json",
    ];
    let calibrated = object(&run(&folder, &loads).done());
    assert_eq!(calibrated["calibration"], "a.toml");
    assert_eq!(calibrated["page"], "a.html");
    assert_eq!(calibrated["full_scale"]["normal"], 2.0);
    assert_eq!(calibrated["elements"].as_array().map(Vec::len), Some(41));
    let rms = &calibrated["elements"][0]["held_out"]["rms"];
    assert!(rms[2].as_f64().is_some_and(|rms| rms > 0.0), "{calibrated}");
    let locate = ["locate", "loads/untouched.png", "-o=layout.toml", "--json"];
    let located = object(&run(&folder, &locate).done());
    assert_eq!(located["elements"], 41);
    assert_eq!(
        (&located["width_px"], &located["polarity"]),
        (&640.into(), &"bright".into())
    );
    assert!(located["warnings"].is_array() && located["rings"].is_null());
    let score = ["score-slip", "cap-closing", "--trials=2", "--json"];
    let scored = object(&run(&folder, &score).done());
    assert_eq!(scored["page"], "slip/slip.html");
    let recall = &scored["detectors"][0]["recall"];
    assert_eq!(recall.as_array().map(Vec::len), Some(3), "{scored}");
}

#[test]
fn setting_is_found_by_part_of_its_key() {
    let folder = folder("set-part");
    let check = |setting: &str| run(&folder, &["check", "cap-closing", "--set", setting]);
    check("slip_threshold=6").done();
    check("cap.radius=0.0139").done();
    // The value is checked under the full key.
    check("slip_threshold=-1").refused(&["control.slip_threshold = -1"]);
    check("slip_treshold=6").refused(&["slip_treshold", "control.slip_threshold"]);
    check("elements=6").refused(&["could mean any of", "sensor.fingertip.layout.rings"]);
    check("task.strokes=3").refused(&["task.screw.strokes is a key"]);
    let two = [
        "check",
        "cap-closing",
        "--set=strokes=3",
        "--set=slip_threshold=6",
    ];
    assert!(run(&folder, &two).done().contains("3 strokes"));
}

#[test]
fn completions_and_manual_pages_are_printed() {
    let folder = folder("completions");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = run(&folder, &["completions", shell]).done();
        assert!(
            script.contains("score-slip") && script.contains("feeler"),
            "{shell}"
        );
    }
    run(&folder, &["completions", "dos"]).refused(&["dos", "bash", "zsh"]);
    let page = run(&folder, &["man"]).done();
    assert!(
        page.contains(".TH feeler 1") && page.contains("feeler\\-sweep"),
        "{page}"
    );
    let page = run(&folder, &["man", "sweep"]).done();
    assert!(
        page.contains(".TH feeler-sweep 1") && page.contains("\\-\\-vary"),
        "{page}"
    );
    run(&folder, &["man", "nothing"]).refused(&["man nothing", "score-slip"]);
}

#[test]
fn help_has_groups_and_fits_the_terminal() {
    let folder = folder("help-groups");
    let help = run(&folder, &["--help"]).done();
    let groups = [
        "Try it:",
        "My fingertip:",
        "My hand:",
        "Experiments:",
        "Several computers:",
        "Options:",
    ];
    let places = groups.map(|group| help.find(group));
    assert!(places.is_sorted() && places[0].is_some(), "{help}");
    for command in ["run", "calibrate", "score-slip"] {
        let help = run(&folder, &[command, "--help"]).done();
        let long = help.lines().find(|line| line.chars().count() > 100);
        assert_eq!(long, None, "{command}");
    }
}
