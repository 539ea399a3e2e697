//! Invalid faults are refused, and likely mistakes cause warnings.

use crate::program::{experiment, folder, run};
use feeler_lab::config::Experiment;

/// Asserts that `feeler check` refuses the reference experiment with `faults`, with all of `words`.
fn refused(name: &str, faults: &str, words: &[&str]) {
    let folder = folder(&format!("faults-{name}"));
    let set = format!("--set=sim.fault=[{faults}]");
    run(&folder, &["check", "cap-closing", &set]).refused(words);
}

#[test]
fn faults_of_missing_parts_are_refused() {
    let cases: [(&str, &str, &[&str]); 20] = [
        (
            "finger",
            "{kind.frozen_frame={finger=2}}",
            &["sim.fault[0].kind.frozen_frame.finger = 2", "0 to 1"],
        ),
        (
            "element",
            "{kind.dead_element={finger=1, element=41}}",
            &["dead_element.element = 41", "0 to 40"],
        ),
        (
            "joint",
            "{kind.servo_stall={finger=0, joint=3}}",
            &["servo_stall.joint = 3", "0 to 2"],
        ),
        (
            "frozen joint",
            "{kind.joint_freeze={finger=0, joint=3}}",
            &["joint_freeze.joint = 3", "0 to 2"],
        ),
        (
            "gain",
            "{kind.joint_gain={finger=0, joint=0, gain=1e4}}",
            &["joint_gain.gain = 10000", "-1000 to 1000"],
        ),
        (
            "jump",
            "{kind.joint_jump={finger=0, joint=0, angle=nan}}",
            &["joint_jump.angle = NaN", "a number"],
        ),
        (
            "swapped with itself",
            "{kind.swapped_sensors={finger=1, other=1}}",
            &["swapped_sensors.other = 1", "another finger"],
        ),
        (
            "swapped with a missing finger",
            "{kind.swapped_sensors={finger=0, other=2}}",
            &["swapped_sensors.other = 2", "0 to 1"],
        ),
        (
            "swapped for a while",
            "{from=1.0, kind.swapped_sensors={finger=0, other=1}}",
            &["sim.fault[0].from", "during the whole run"],
        ),
        (
            "row",
            "{kind.stuck_rows={finger=0, first=480, count=1, gray=0}}",
            &["stuck_rows.first = 480", "0 to 479"],
        ),
        (
            "rows",
            "{kind.stuck_rows={finger=0, first=400, count=100, gray=0}}",
            &["stuck_rows.count = 100", "1 to 80"],
        ),
        (
            "gray",
            "{kind.stuck_rows={finger=0, first=0, count=1, gray=256}}",
            &["256", "0 to 255"],
        ),
        (
            "probability",
            "{kind.dropped_frames={finger=0, probability=1.1}}",
            &["dropped_frames.probability = 1.1", "0 to 1"],
        ),
        (
            "delay",
            "{kind.camera_latency={finger=0, delay=-0.1}}",
            &["camera_latency.delay = -0.1", "0 to 10"],
        ),
        (
            "angle",
            "{kind.backlash={finger=0, joint=0, angle=nan}}",
            &["backlash.angle = NaN"],
        ),
        (
            "factor",
            "{kind.friction_drop={factor=2.0}}",
            &["friction_drop.factor = 2", "0 to 1"],
        ),
        (
            "object",
            "{kind.friction_drop={object=\"lid\", factor=0.5}}",
            &[
                "friction_drop.object = \"lid\"",
                "the name of an object: cap",
            ],
        ),
        (
            "until",
            "{from=2.0, until=1.0, kind.frozen_frame={finger=0}}",
            &["sim.fault[0].until = 1", "sim.fault[0].from = 2"],
        ),
        (
            "kind",
            "{kind.gremlins={finger=0}}",
            &["gremlins", "dead_element"],
        ),
        (
            "key",
            "{kind.frozen_frame={finger=0, element=1}}",
            &["element"],
        ),
    ];
    for (name, faults, words) in cases {
        refused(name, faults, words);
    }
}

#[test]
fn stuck_rows_without_images_cause_a_warning() {
    let folder = folder("faults-no-pictures");
    let fault = "--set=sim.fault=[{kind.stuck_rows={finger=0, first=0, count=9, gray=0}}]";
    let said = run(
        &folder,
        &["check", "cap-closing", fault, "--set=sensing=direct"],
    )
    .done();
    assert!(
        said.contains("warning: sim.fault[0].kind.stuck_rows"),
        "{said}"
    );
    assert!(said.contains("good"), "{said}");
    let said = run(&folder, &["check", "cap-closing", fault]).done();
    assert!(!said.contains("warning"), "{said}");
}

#[test]
fn runs_of_an_experiment_file_with_faults_are_reproducible() {
    let folder = folder("faults-in-a-file");
    let faults = "[[sim.fault]]\nkind.dead_element = { finger = 0, element = 3 }\n\n\
        [[sim.fault]]\nkind.friction_drop = { object = \"cap\", factor = 0.3 }\nfrom = 2.0\nuntil = 3.0\n\n\
        [sim.variation]";
    experiment(&folder, "[sim.variation]", faults);
    assert!(run(&folder, &["check", "my.toml"]).done().contains("good"));
    let direct = ["run", "my.toml", "--sensing=direct", "--out"];
    run(&folder, &[&direct[..], &["a"]].concat());
    run(&folder, &[&direct[..], &["b"]].concat());
    let digest = |name: &str| std::fs::read_to_string(folder.join(name).join("summary.json"));
    let of = |name: &str| {
        let summary: serde_json::Value = serde_json::from_str(&digest(name).unwrap()).unwrap();
        summary["digest"].clone()
    };
    assert_eq!(of("a"), of("b"));
    assert!(of("a").is_string());
}

#[test]
fn oval_and_eccentric_caps_are_closed() {
    let folder = folder("faults-odd-caps");
    let odd = [
        "--set=sim.object.cap.offset=[0.0005, 0.0, 0.0]",
        "--set=sim.object.cap.shape={knurled_cylinder={radius=0.014, height=0.02, knurls=0, depth=0.0, ovality=0.03}}",
        "--set=sim.object.cap.shape={knurled_cylinder={radius=0.014, height=0.02, knurls=60, depth=0.0003}}",
    ];
    for (number, set) in odd.iter().enumerate() {
        let out = number.to_string();
        let run = run(
            &folder,
            &["run", "cap-closing", "--sensing=direct", set, "--out", &out],
        );
        assert!(run.done().contains("claims of the paper pass"));
        let summary = std::fs::read_to_string(folder.join(&out).join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        assert_eq!(summary["strokes"].as_array().unwrap().len(), 4, "{set}");
    }
}

#[test]
fn documented_tables_are_valid_in_an_experiment() {
    let mut text = include_str!("../../../../feeler-lab/experiments/cap-closing.toml").to_string();
    let readme = include_str!("../../../../../docs/experiment-files.md")
        .split("```toml\n")
        .skip(1);
    let shown = readme.filter_map(|rest| rest.split("```").next());
    for block in shown {
        text = format!("{text}\n{block}");
    }
    let experiment = Experiment::parse(&text, "the README", &[], None).expect("an experiment");
    let config = experiment.config;
    let sim = config.sim.expect("a simulated world");
    assert_eq!((sim.object.len(), sim.fault.len()), (3, 1));
    assert_eq!(config.sensor.finger.len(), 2);
}
