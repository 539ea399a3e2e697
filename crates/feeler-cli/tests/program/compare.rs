//! `feeler compare`, and the control laws that it compares.

use crate::program::{Ended, document, feeler, folder, rows, run};
use feeler::control::law::LawConfig;
use feeler_lab::sweep::Table;
use feeler_lab::sweep::analysis::{Candidate, Goal, compare as compare_tables};
use std::collections::HashMap;
use std::fs;

const LAWS: [&str; 5] = [
    "tri-axial",
    "tri-axial-missing-shear",
    "normal-only",
    "open-loop",
    "best",
];

fn compare<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["compare", "cap-closing", "--seed=11"], more].concat()
}

fn mean(rows: &[HashMap<String, String>], value: impl Fn(&HashMap<String, String>) -> f64) -> f64 {
    rows.iter().map(value).sum::<f64>() / rows.len() as f64
}

fn peak_force(row: &HashMap<String, String>) -> f64 {
    let strokes = (1..=4).map(|k| row[&format!("stroke{k}.peak_element_force")].parse::<f64>());
    strokes
        .map(|force| force.expect("a force"))
        .fold(0.0, f64::max)
}

#[test]
fn single_trial_has_no_interval() {
    let folder = folder("compare-one");
    let arguments = [
        "compare",
        "cap-closing",
        "--trials=1",
        "--laws=tri-axial,best",
        "--set=task.screw.strokes=1",
    ];
    let said = run(&folder, &arguments).done();
    let torque = said.lines().find(|line| line.contains("final torque"));
    assert!(torque.unwrap().ends_with("(no interval)"), "{said}");
    assert!(said.contains("not comparable on a single trial"), "{said}");
    let page = document(&folder.join("compare/compare.html"));
    assert!(
        page.contains("For a single trial, only success has an interval")
            && page.contains("(no interval)")
    );
    assert!(!page.contains("NaN"));
}

#[test]
fn laws_are_compared_on_the_same_trials_and_best_beats_the_papers_law() {
    let folder = folder("compare-laws");
    let said = run(&folder, &compare(&["--trials=24", "-o=c"])).done();
    assert!(
        said.contains("best compared with tri-axial: more torque at less force"),
        "{said}"
    );
    let tables: Vec<_> = LAWS
        .map(|law| rows(&folder.join("c").join(law).join("trials.csv")))
        .into();
    for table in &tables {
        assert_eq!(table.len(), 24);
        for (own, first) in table.iter().zip(&tables[0]) {
            for drawn in [
                "seed",
                "friction",
                "sim.object.cap.offset.0",
                "direct_sensing.shear_noise",
            ] {
                assert_eq!(own[drawn], first[drawn], "{drawn}");
            }
            assert!((0.4..1.2).contains(&own["friction"].parse::<f64>().unwrap()));
            // The feelers slipped over the turned cap, and friction only dissipates energy.
            assert!(own["slip_work"].parse::<f64>().unwrap() > 0.0);
        }
    }
    let [paper, best] = [&tables[0], &tables[4]];
    let torque = |row: &HashMap<String, String>| row["cap_torque"].parse::<f64>().unwrap();
    // 200 trials show 20 % more (docs/comparing-control-laws.md): with soft feelers, the paper's law leaves less to gain.
    assert!(mean(best, torque) > 1.1 * mean(paper, torque));
    assert!(mean(best, peak_force) < mean(paper, peak_force));
    // The torque that the seat holds is the largest measured torque, up to the static friction factor and the noise. A
    // peak between two samples, 10 ms apart, is measured only in part. In 1,200 trials of another seed, the smallest
    // ratio is 0.948, two are below 0.95, and the largest is 1.047.
    for row in best {
        let seen = (1..=4).map(|k| {
            row[&format!("stroke{k}.peak_torque")]
                .parse::<f64>()
                .unwrap()
        });
        let seen = seen.fold(0.0, f64::max);
        let ratio = seen / torque(row);
        assert!((0.94..1.1).contains(&ratio), "{ratio}");
    }
    let page = document(&folder.join("c/compare.html"));
    for word in [
        "success (%) against friction",
        "lines of code",
        "Wilson",
        "distance to axis, std (mm)",
        "curvature relative to the arc",
        "grip variation",
    ] {
        assert!(page.contains(word), "no {word:?}");
    }
    assert!(!page.contains("INCOMPLETE") && !page.contains("NaN"));
}

#[test]
fn paths_are_compared_over_the_strokes_in_which_the_cap_is_closed() {
    let columns = ["trial", "stroke2", "stroke3", "stroke4"];
    let header = columns.map(|name| match name {
        "trial" => name.to_string(),
        stroke => format!("{stroke}.path_radius_std"),
    });
    let mut table = Table::new(header.to_vec());
    for (trial, row) in [["0", "9", "0.001", "0.003"], ["1", "9", "0.004", ""]]
        .iter()
        .enumerate()
    {
        let row = row.map(String::from).to_vec();
        table.rows.insert(trial as u64, row);
    }
    let candidate = Candidate {
        name: "tri-axial",
        law: LawConfig::TriAxial,
        table: &table,
    };
    let goal = Goal {
        torque: 0.05,
        force: 2.5,
    };
    let page = compare_tables(&[candidate], goal, None);
    let mean = |name: &str| {
        let row = page.laws[0].rows.iter().find(|row| row.name == name);
        row.expect("a row").value.map(|[_, mean, _]| mean)
    };
    // The mean of 2 mm, from strokes 3 and 4, and 4 mm, because the second trial has no fourth stroke.
    let spread = mean("distance to axis, std (mm)").expect("a mean");
    assert!((spread - 3.0).abs() < 1e-9, "{spread}");
    // A missing column has no value.
    assert_eq!(mean("curvature relative to the arc"), None);
}

#[test]
fn resumed_comparison_gives_the_same_result() {
    let folder = folder("compare-resumed");
    let laws = ["--laws=best,open-loop", "--trials=6"];
    run(
        &folder,
        &compare(&[&laws[..], &["--jobs=1", "-o=one"]].concat()),
    )
    .done();
    run(
        &folder,
        &compare(&[&laws[..], &["--jobs=2", "-o=two"]].concat()),
    )
    .done();
    let read = |name: &str| fs::read(folder.join(name)).unwrap();
    let whole = read("one/best/trials.csv");
    assert_eq!(whole, read("two/best/trials.csv"));
    assert_eq!(read("one/compare.html"), read("two/compare.html"));

    // State after an interruption: the second law has two rows, the first has all.
    let lines: Vec<_> = read("two/open-loop/trials.csv");
    let lines: Vec<_> = lines.split_inclusive(|&b| b == b'\n').collect();
    fs::remove_file(folder.join("two/open-loop/trials.csv")).unwrap();
    fs::write(
        folder.join("two/open-loop/trials.csv.part"),
        lines[..3].concat(),
    )
    .unwrap();
    run(
        &folder,
        &compare(&[&laws[..], &["--resume", "-o=two"]].concat()),
    )
    .done();
    assert_eq!(
        read("one/open-loop/trials.csv"),
        read("two/open-loop/trials.csv")
    );
    assert_eq!(read("one/compare.html"), read("two/compare.html"));
    let other = ["--laws=best", "--trials=7", "--resume", "-o=two"];
    run(&folder, &compare(&other)).refused(&["best", "number of trials"]);
    run(&folder, &compare(&[&laws[..], &["-o=two"]].concat()))
        .refused(&["already contains a sweep"]);

    let ended = run(
        &folder,
        &["run", "--trial", "one/best", "2", "--out", "again"],
    );
    assert!(matches!(ended.status, Some(0 | 1)), "{ended:?}");
}

#[cfg(unix)]
#[test]
fn interrupted_comparison_keeps_the_trials_of_all_laws() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let folder = folder("compare-interrupted");
    let arguments = compare(&[
        "--laws=tri-axial,best",
        "--trials=100000",
        "--jobs=1",
        "-o=c",
    ]);
    let mut command = feeler(&folder, &arguments);
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let part = folder.join("c/best/trials.csv.part");
    let rows = || fs::read_to_string(&part).map_or(0, |text| text.lines().count());
    let start = Instant::now();
    while rows() < 4 && start.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(20));
    }
    let pid = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .unwrap()
            .success()
    );
    let ended = Ended::of(child.wait_with_output().unwrap());
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("--resume"), "{ended:?}");
    let page = document(&folder.join("c/compare.html"));
    assert!(page.contains("INCOMPLETE"));
}

#[test]
fn invalid_arguments_are_refused_before_the_first_trial() {
    let folder = folder("compare-refused");
    for (arguments, words) in [
        (
            &["--laws=tri-axial,worst"][..],
            &["worst", "normal-only"][..],
        ),
        (&["--laws=best,best"], &["best", "twice"]),
        (&["--trials=0"], &["0", "1.."]),
        (&["--goal-torque=0"], &["--goal-torque", "more than 0"]),
        (&["--goal-force=nan"], &["--goal-force", "more than 0"]),
        (&["--vary=friction=uniform(2,1)"], &["must not exceed"]),
        (
            &["--set=control.over_force=0.05"],
            &["control.over_force", "touch_force"],
        ),
        (
            &["--set=control.law={ best = { element_force = 0.01 } }"],
            &[
                "control.law.best.element_force = 0.01",
                "more than control.touch_force (F1)",
            ],
        ),
        (
            &["--set=control.law=fuzzy"],
            &["fuzzy", "tri-axial, tri-axial-missing-shear, normal-only"],
        ),
        (
            &["--set=control.law={ best = { margin = 0.5 } }"],
            &["control.law.best.margin = 0.5", "1 to 100"],
        ),
        (
            &["--set=control.law={ best = { glue = 1 } }"],
            &["glue", "margin"],
        ),
        (
            &["--set=control.law={ best = {}, open-loop = {} }"],
            &["one control law"],
        ),
        (
            &["--set=control.law={ tri-axial-missing-shear = { threshold = 0.0 } }"],
            &["tri-axial-missing-shear.threshold = 0", "more than 0"],
        ),
        (
            &["--set=control.law={ tri-axial-missing-shear = { feeler = 3 } }"],
            &["control.law", "feeler"],
        ),
        (
            &["--set=control.law={ normal-only = { friction = 0.0 } }"],
            &["normal-only.friction = 0", "0.01 to 10"],
        ),
    ] {
        run(&folder, &compare(&[arguments, &["-o=c"]].concat())).refused(words);
        assert!(!folder.join("c").exists(), "{arguments:?}");
    }
    // In these experiments, all control laws would behave the same.
    for name in ["cap-until-closed", "lift"] {
        let words = [
            name,
            "control laws have no effect",
            "task.screw with until = \"strokes\"",
        ];
        run(&folder, &["compare", name, "-o=c"]).refused(&words);
        assert!(!folder.join("c").exists(), "{name}");
    }
    run(&folder, &["compare", "nothing"]).refused(&["nothing", "cap-closing"]);
}
