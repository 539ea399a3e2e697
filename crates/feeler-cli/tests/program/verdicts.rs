//! Success criteria of the built-in experiments.

use crate::program::{folder, run, summary};

const PAPERS: &str = "the task was completed and all its claims pass";
const CLOSED: &str =
    "the task was completed, the cap was closed at the last stroke, and no element was overloaded";

/// The built-in experiments with their success criteria.
const EXPERIMENTS: [(&str, &str); 15] = [
    ("cap-closing", PAPERS),
    ("any-hand", "all five claims of any hand pass"),
    (
        "cap-opening",
        "the cap was detected open, turned as far as measured by touch",
    ),
    ("cap-until-closed", "the cap was detected closed, is tight"),
    ("cap-closing-pins", CLOSED),
    ("cap-closing-fibres", CLOSED),
    ("cap-closing-gel", CLOSED),
    ("three-fingers", CLOSED),
    ("contour", PAPERS),
    ("friction-scan", PAPERS),
    ("slide-box", PAPERS),
    ("slide-box-two", PAPERS),
    ("lift", PAPERS),
    ("grip", PAPERS),
    ("bench-rig", "every stroke turned the cap"),
];

#[test]
fn every_built_in_experiment_meets_its_criterion() {
    let folder = folder("verdicts");
    let listed = run(&folder, &["list"]).done();
    for (experiment, words) in EXPERIMENTS {
        assert!(listed.contains(experiment));
        let out = format!("-o={experiment}");
        let arguments = [
            "sweep",
            experiment,
            "--trials=1",
            "--sensing=direct",
            "--seed=7",
            &out,
        ];
        let said = run(&folder, &arguments).done();
        let good = said.contains("1 of 1 trials succeeded") && said.contains(words);
        assert!(good, "{experiment}: {said}");
    }
    let built_in = listed.lines().take_while(|line| !line.is_empty());
    assert_eq!(built_in.count(), EXPERIMENTS.len());
}

#[test]
fn reports_and_sweeps_use_the_same_criterion() {
    let folder = folder("verdicts-run");
    let thread = "sim.object.cap.motion.thread";
    let tight = format!("--set={thread}.seat_angle=-0.5");
    let far = format!("--set={thread}.seat_angle=9.0");
    let nothing = "--set=seed=3";
    let cases: [(&str, &str, &str, bool); 6] = [
        ("cap-opening", nothing, "detected open", true),
        ("cap-opening", &tight, "detected open", false),
        ("bench-rig", nothing, "every stroke turned the cap", true),
        (
            "three-fingers",
            nothing,
            "the cap was closed at the last stroke",
            true,
        ),
        ("cap-closing", nothing, "all its claims pass", true),
        ("cap-closing", &far, "all its claims pass", false),
    ];
    for (number, (experiment, setting, words, met)) in cases.into_iter().enumerate() {
        let out = format!("{number}");
        let ended = run(
            &folder,
            &[
                "run",
                experiment,
                "--sensing=direct",
                setting,
                "--out",
                &out,
            ],
        );
        let success = &summary(&folder.join(&out))["success"];
        assert_eq!(success["met"], met, "{experiment} {setting}: {ended:?}");
        let criterion = success["criterion"].as_str().expect("a criterion");
        assert!(criterion.contains(words), "{criterion}");
        if !words.contains("claims") {
            let line = ended
                .stdout
                .lines()
                .find(|line| line.starts_with("success: "));
            let yes = line.expect("a verdict").starts_with("success: yes");
            assert_eq!(yes, met, "{ended:?}");
        }
    }
}

/// More strokes than in the paper are judged like four: by a peak in each stroke, and a closed cap.
#[test]
fn closing_the_cap_in_more_strokes_is_a_success() {
    let folder = folder("verdicts-strokes");
    let arguments = [
        "sweep",
        "cap-closing",
        "--trials=3",
        "--sensing=direct",
        "--seed=7",
        "--set=strokes=6",
        "-o=six",
    ];
    let said = run(&folder, &arguments).done();
    assert!(
        said.contains("3 of 3 trials succeeded") && said.contains(PAPERS),
        "{said}"
    );
}
