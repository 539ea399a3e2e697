//! Reports of synthetic runs on rigs with few or no instruments besides the hand, as on real rigs.

use super::report::document;
use crate::support::{self, REAL, Rig};
use feeler_record::{FindingName, Findings, Recording, TaskKind, TaskOutcome};
use feeler_report::run::make;
use feeler_report::{ReportOutcome, RunData, Summary, Verdict, tasks};
use std::fs;
use std::path::{Path, PathBuf};

/// Separate directory with a run on `rig`.
fn run(name: &str, rig: Rig) -> PathBuf {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("real-rig")
        .join(name);
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).unwrap();
    support::write_run_on(&directory.join("recording.mcap"), rig).unwrap();
    directory
}

fn recording(name: &str, rig: Rig) -> Recording {
    Recording::read(run(name, rig).join("recording.mcap")).unwrap()
}

fn summary(name: &str, rig: Rig) -> Summary {
    let recording = recording(name, rig);
    Summary::new(&recording, &RunData::new(&recording))
}

/// Ids of the claims with this verdict.
fn ids(summary: &Summary, verdict: Verdict) -> Vec<&'static str> {
    let claims = summary.claims.iter().filter(|c| c.verdict == verdict);
    claims.map(|claim| claim.id).collect()
}

/// Text in a figure's SVG, checked to contain no NaN.
fn texts(directory: &Path, figure: &str) -> String {
    let svg = fs::read_to_string(directory.join(format!("figures/{figure}.svg"))).unwrap();
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{figure}");
    let document = roxmltree::Document::parse(&svg).unwrap();
    let texts = document.descendants().filter_map(|node| node.text());
    texts.collect::<Vec<_>>().join("|")
}

/// The report's page and summary, checked to contain no NaN.
fn written(outcome: &ReportOutcome) -> (String, String) {
    let [page, json] =
        [&outcome.report_path, &outcome.summary_path].map(|path| fs::read_to_string(path).unwrap());
    let page = document(&page);
    assert!(!page.contains("NaN") && !json.contains("NaN"));
    (page, json)
}

#[test]
fn without_instruments_strokes_are_measured_by_tactile_data() {
    let outcome = make(run("bare", REAL)).unwrap();
    let whole = summary("whole", support::SIMULATED);
    assert_eq!(outcome.summary.strokes.len(), 4);
    for (bare, whole) in outcome.summary.strokes.iter().zip(&whole.strokes) {
        assert!(bare.mean_grasp_force.is_some());
        let felt = |s: &feeler_report::StrokeMeasures| {
            (
                [s.mean_grasp_force, s.peak_grasp_force, s.peak_shear_rate],
                [s.slip_fraction, s.over_fraction, s.path_inward_bend],
            )
        };
        assert_eq!(felt(bare), felt(whole));
        let by_instruments = [bare.peak_torque, bare.cap_turn, bare.slip_precision];
        assert_eq!(by_instruments, [None; 3]);
        assert_eq!((bare.path_radius_std, bare.path_curvature), (None, None));
    }
    let summary = &outcome.summary;
    assert_eq!((summary.final_torque, summary.cap_angle), (None, None));
    let (page, json) = written(&outcome);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(json["strokes"][3]["peak_torque"].is_null());
    assert!(page.contains("Done."), "the page lacks the final phase");
    assert!(page.contains("the hand made 4 of 4 strokes."));
    assert!(page.contains("Not measured: Peak torque; Cap rotation; Precision of SLIP"));
}

#[test]
fn claims_that_require_an_instrument_are_not_measured() {
    let outcome = make(run("claims", REAL)).unwrap();
    let unmeasured = [
        "four-peaks",
        "first-stroke-torque-rises",
        "closed-after-third",
        "bumps-in-step",
        "slip-means-slip",
        "path-follows-contour",
        "path-is-curved",
    ];
    assert_eq!(ids(&outcome.summary, Verdict::NotMeasured), unmeasured);
    assert_eq!(
        ids(&outcome.summary, Verdict::Holds),
        [
            "shear-rate-marks-closing",
            "grip-levels-off",
            "path-saturates",
            "no-damage"
        ]
    );
    let (page, _) = written(&outcome);
    let verdict = format!("not measured: {}", unmeasured.join(", "));
    assert!(page.contains(&verdict) && !page.contains("✗ fail"));
}

#[test]
fn figures_without_instruments_are_drawn_and_do_not_mention_them() {
    let directory = run("figures", REAL);
    let (page, _) = written(&make(&directory).unwrap());
    for (figure, axis) in [
        ("fig-08", "Grasp force (N)"),
        ("fig-09", "Shear rate (N/s)"),
        ("fig-10", "SLIP"),
        ("fig-11", "SLIP"),
        ("fig-12", "planned line"),
        ("fig-13", "planned line"),
    ] {
        let texts = texts(&directory, figure);
        assert!(texts.contains(axis), "{figure}: {texts}");
        for absent in ["orque", "arc", "true", "|cap"] {
            assert!(!texts.contains(absent), "{figure}: {absent} in {texts}");
        }
        let time = ["fig-12", "fig-13"].contains(&figure) || texts.contains("Time (s)");
        assert!(time, "{figure}: {texts}");
    }
    // R is the distance from an unknown axis.
    assert!(!directory.join("figures/fig-14.svg").exists());
    assert_eq!(page.matches("Not in this recording.").count(), 1);
    let captions = page.split("<figcaption>").skip(1).map(|rest| {
        let caption = rest.split("</figcaption>").next().unwrap_or("");
        assert!(!caption.contains("true slip"), "{caption}");
        caption
    });
    // The caption of the missing figure describes its intended content.
    let captions: Vec<_> = captions.collect();
    assert!(
        captions[..6]
            .iter()
            .all(|c| !c.contains("orque") && !c.contains("dotted arc"))
    );
}

#[test]
fn a_torque_sensor_alone_is_reported() {
    let rig = Rig {
        torque_from: Some(0.0),
        ..REAL
    };
    let directory = run("torque", rig);
    let outcome = make(&directory).unwrap();
    let whole = summary("torque-whole", support::SIMULATED);
    let torques = |s: &Summary| s.strokes.iter().map(|s| s.peak_torque).collect::<Vec<_>>();
    assert_eq!(torques(&outcome.summary), torques(&whole));
    assert_eq!(outcome.summary.final_torque, whole.final_torque);
    assert_eq!(
        ids(&outcome.summary, Verdict::NotMeasured),
        [
            "closed-after-third",
            "slip-means-slip",
            "path-follows-contour",
            "path-is-curved"
        ]
    );
    for figure in ["fig-08", "fig-09", "fig-10", "fig-11"] {
        let texts = texts(&directory, figure);
        assert!(texts.contains("Torque (mN·m)"), "{figure}: {texts}");
    }
}

#[test]
fn a_torque_sensor_that_starts_late_drops_no_rows() {
    let whole = RunData::new(&recording("late-whole", support::SIMULATED));
    // In SEARCH of stroke 1, and in its MOVE, which lasts from 0.9 to 1.9 s.
    for (from, measured) in [(0.5, true), (1.2, false)] {
        let rig = Rig {
            torque_from: Some(from),
            ..REAL
        };
        let directory = run(&format!("late-{from}"), rig);
        let outcome = make(&directory).unwrap();
        written(&outcome);
        let data = RunData::new(&Recording::read(directory.join("recording.mcap")).unwrap());
        assert_eq!((&data.time, data.time[0]), (&whole.time, 0.0));
        let torque = data.torque.as_ref().expect("a torque sensor");
        let unknown = torque.iter().filter(|torque| torque.is_nan()).count();
        assert_eq!(unknown, (from / support::PERIOD).round() as usize);
        let strokes = &outcome.summary.strokes;
        assert_eq!(strokes[0].peak_torque.is_some(), measured);
        assert!(strokes[1].peak_torque.is_some());
        let unmeasured = ids(&outcome.summary, Verdict::NotMeasured);
        for claim in ["four-peaks", "first-stroke-torque-rises"] {
            assert_eq!(unmeasured.contains(&claim), !measured, "{claim}");
        }
        assert!(ids(&outcome.summary, Verdict::Holds).contains(&"bumps-in-step"));
        for figure in ["fig-08", "fig-10", "fig-12"] {
            texts(&directory, figure);
        }
    }
}

#[test]
fn findings_about_a_cap_are_reported_without_ground_truth() {
    let rig = Rig {
        feels: true,
        ..REAL
    };
    let directory = run("felt", rig);
    let outcome = make(&directory).unwrap();
    let (page, _) = written(&outcome);
    for text in [
        "Outcome: <b>closed</b>.",
        "Outcome reported by the hand: <b>closed</b>",
        "Estimated torque and rotation",
        "Peak torque, estimated",
        "not measured",
    ] {
        assert!(page.contains(text), "no {text:?}");
    }
    for text in ["of the paper", "Peak torque, measured (mN·m)", "true angle"] {
        assert!(!page.contains(text), "{text:?}");
    }
    let texts = texts(&directory, "fig-01");
    assert!(
        texts.contains("estimated") && !texts.contains("friction limit"),
        "{texts}"
    );
    let cap = outcome.summary.cap.expect("a cap");
    let felt: Vec<_> = cap.strokes.iter().map(|stroke| stroke.felt_turn).collect();
    assert!(
        felt.len() == 4 && felt.iter().all(Option::is_some),
        "{felt:?}"
    );
    assert_eq!((cap.final_torque, cap.friction_limit), (None, None));
}

/// Recording of another task with the synthetic run's fingers and with these findings at every step.
fn of_task(task: TaskKind, names: &[FindingName], outcome: TaskOutcome) -> Recording {
    let mut recording = recording(&format!("{task}"), REAL);
    recording.facts.task = task;
    recording.findings = (recording.task.iter())
        .map(|step| Findings {
            stamp: step.stamp,
            outcome: Some(outcome.clone()),
            names: names.to_vec(),
            values: vec![0.001 * step.stamp; names.len()],
        })
        .collect();
    recording
}

#[test]
fn findings_about_an_object_are_drawn_without_ground_truth() {
    let moved = [
        FindingName::MovedX,
        FindingName::MovedY,
        FindingName::MovedZ,
    ];
    let drawn = [FindingName::SurfaceX, FindingName::SurfaceY];
    for (task, names, outcome, legend) in [
        (
            TaskKind::Carry,
            &moved[..],
            TaskOutcome::Carried,
            "estimated",
        ),
        (TaskKind::Contour, &drawn, TaskOutcome::Closed, "measured"),
    ] {
        let recording = of_task(task.clone(), names, outcome);
        let data = RunData::new(&recording);
        let report = tasks::of_recording(&recording);
        let figures = report.figures(&recording, &data);
        let svg = figures[0].svg.as_ref().expect("a picture");
        assert!(svg.contains(legend) && !svg.contains("true"), "{task}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{task}");
        assert!(!figures[0].caption.contains("simulator"), "{task}");
        let claims = report.claims(&recording, &data, &data.stroke_measures());
        assert!(
            claims.iter().all(|claim| claim.verdict != Verdict::Fails),
            "{claims:#?}"
        );
    }
}
