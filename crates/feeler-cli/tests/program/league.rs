//! `feeler league` on synthetic sets with a known result, with programs that answer, fail and lie.

use crate::program::{document, feeler, folder, rows, run};
use crate::recordings::recordings;
use crate::sense::interrupted::interrupt;
use serde_json::Value;
use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::yield_now;

/// Reading that only recordings with slip contain.
const MARK: &str = "7777";

const LAYOUT: &str = r#"version = 1
name = "two pillars"
unit = "counts"
columns = { x = "p{n}_x", y = "p{n}_y", z = "p{n}_z", time = { column = "t", unit = "s" } }
taxel = [{ place = [0.0, 0.0, 0.0] }, { place = [0.0, 0.01, 0.0] }]
"#;

const HEADER: &str = "t,p0_x,p0_y,p0_z,p1_x,p1_y,p1_z\n";

/// Writes a set of three runs of a pillar whose column z is twice the force, with some noise-free curvature.
fn pillar(folder: &Path) {
    let folder = folder.join("pillar");
    fs::create_dir_all(&folder).unwrap();
    for run in 0..3 {
        let (mut table, mut scale) = (HEADER.to_string(), "0.05,-1\n".to_string());
        for row in 0..60 {
            let time = 0.1 * f64::from(row);
            let force = 2.0 + (0.9 * time + f64::from(run)).sin();
            writeln!(table, "{time:.1},0,0,{},1,{},0", 2.0 * force, force * force).unwrap();
            writeln!(scale, "{time:.1},{}", 1e3 * force).unwrap();
        }
        fs::write(folder.join(format!("run-{run}.csv")), table).unwrap();
        fs::write(folder.join(format!("scale-{run}.csv")), scale).unwrap();
    }
    fs::write(folder.join("layout.toml"), LAYOUT).unwrap();
    let definition = r#"version = 1
name = "pillar"
title = "Force on a pillar"
source = "this test"
licence = "MIT"
split = { by = "group", folds = 3 }
chosen_here = ["wrench"]

[values]
metric = "rmse"
targets = [{ name = "f_z", column = "millinewtons", unit = "N", factor = 0.001, at_least = 0.0 }]

[values.taxels]
layout = "layout.toml"
tables = "run-*.csv"
targets = "scale-*.csv"
time = "time"
without_header = ["time", "millinewtons"]

[[published]]
metric = "rmse"
value = "0.5 N"
source = "a paper"
"#;
    fs::write(folder.join("pillar.league.toml"), definition).unwrap();
}

/// Writes a set of twelve grasps of six objects. Half of them slip: their last readings contain [`MARK`].
fn grasps(folder: &Path) {
    let folder = folder.join("grasps");
    fs::create_dir_all(folder.join("tables")).unwrap();
    let mut labels = "recording,object,slip\n".to_string();
    for grasp in 0..12 {
        let mut table = HEADER.to_string();
        for row in 0..30 {
            let x = if grasp % 2 == 1 && row > 20 {
                MARK
            } else {
                "10"
            };
            writeln!(table, "{:.1},{x},{},5,0,0,0", 0.1 * f64::from(row), row % 2).unwrap();
        }
        fs::write(folder.join(format!("tables/secret-{grasp}.csv")), table).unwrap();
        writeln!(labels, "secret-{grasp},object-{},{}", grasp / 2, grasp % 2).unwrap();
    }
    fs::write(folder.join("labels.csv"), labels).unwrap();
    fs::write(folder.join("layout.toml"), LAYOUT).unwrap();
    let definition = r#"version = 1
name = "grasps"
title = "Slip on two pillars"
source = "this test"
licence = "MIT"
split = { by = "group", folds = 3 }

[slip]
recordings = "tables"
labels = "labels.csv"
taxels = "layout.toml"
group = "object"
"#;
    fs::write(folder.join("grasps.league.toml"), definition).unwrap();
}

/// Results by set, metric and entry.
fn results(folder: &Path) -> HashMap<[String; 3], HashMap<String, String>> {
    let rows = rows(&folder.join("league/league.csv")).into_iter();
    let key =
        |row: &HashMap<String, String>| ["set", "metric", "entry"].map(|key| row[key].clone());
    rows.map(|row| (key(&row), row)).collect()
}

fn value(folder: &Path, [set, metric, entry]: [&str; 3]) -> f64 {
    let key = [set, metric, entry].map(str::to_owned);
    let results = results(folder);
    let row = results.get(&key).unwrap_or_else(|| panic!("no {key:?}"));
    row["value"].parse().unwrap_or_else(|_| panic!("{row:?}"))
}

/// A program for the shell that answers each test sample with the probability `yes` if it contains [`MARK`], else `no`.
fn judge(yes: &str, no: &str) -> String {
    format!(
        r#"i=0; while IFS= read -r line; do case "$line" in *'"part":"test"'*) case "$line" in *{MARK}*) s={yes};; *) s={no};; esac; echo "{{\"sample\":$i,\"slip\":$s}}"; i=$((i+1));; esac; done"#
    )
}

#[test]
fn values_are_predicted_by_baselines_and_the_calibration() {
    let folder = folder("league-values");
    pillar(&folder);
    let ended = run(&folder, &["league", ".", "--json"]);
    let printed: Value = serde_json::from_str(&ended.done()).unwrap();
    let set = &printed["sets"][0];
    assert_eq!(
        (&set["name"], &set["published"][0]["value"]),
        (&"pillar".into(), &"0.5 N".into())
    );
    // The constant answer errs by the standard deviation of the force, about that of a sine, sqrt(1/2).
    let error = |entry| value(&folder, ["pillar", "rmse f_z", entry]);
    assert!(
        (0.6..0.85).contains(&error("constant")),
        "{}",
        error("constant")
    );
    for entry in ["ridge", "quadratic_ridge", "wrench"] {
        assert!(error(entry) < 0.02, "{entry}: {}", error(entry));
    }
    let page = document(&folder.join("league/league.html"));
    for word in [
        "Force on a pillar",
        "wrench calibration *",
        "0.5 N (a paper)",
        "eflesh-slip",
    ] {
        assert!(page.contains(word), "no {word:?}");
    }
    let table = fs::read(folder.join("league/league.csv")).unwrap();
    run(&folder, &["league", "."]).refused(&["league.html", "--force"]);
    run(&folder, &["league", ".", "--force"]).done();
    assert_eq!(fs::read(folder.join("league/league.csv")).unwrap(), table);
}

#[cfg(unix)]
#[test]
fn a_program_gets_no_label_of_the_test_part() {
    let folder = folder("league-program");
    grasps(&folder);
    let good = format!("good=tee -a seen.jsonl | ({})", judge("0.9", "0.2"));
    let bad = format!("bad={}", judge("0.4", "0.6"));
    let text = run(&folder, &["league", ".", "--entry", &good, "--entry", &bad]).done();
    assert!(text.contains("12 recordings in 6 groups"), "{text}");
    for (entry, right, auc) in [
        ("good", 1.0, 1.0),
        ("bad", 0.0, 0.0),
        ("shear", 1.0, 1.0),
        ("constant", 0.5, 0.5),
    ] {
        let found = ["accuracy", "auc"].map(|metric| value(&folder, ["grasps", metric, entry]));
        assert_eq!(found, [right, auc], "{entry}");
    }
    for detector in feeler_lab::grasps::DETECTORS {
        let key = ["grasps", "auc", detector.key()].map(str::to_owned);
        assert!(results(&folder).contains_key(&key), "{key:?}");
    }
    let seen = fs::read_to_string(folder.join("seen.jsonl")).unwrap();
    assert!(
        !seen.contains("secret") && !seen.contains("object"),
        "names may reveal labels"
    );
    let (mut train, mut test) = (0, 0);
    for line in seen.lines() {
        let line: Value = serde_json::from_str(line).unwrap();
        match line["part"].as_str() {
            Some("train") => {
                let marked = line["values"]
                    .as_array()
                    .unwrap()
                    .iter()
                    .any(|row| row[0] == 7777.0);
                assert_eq!(line["slip"], marked);
                train += 1;
            }
            Some(_) => {
                let keys: Vec<_> = line.as_object().unwrap().keys().cloned().collect();
                assert_eq!(keys, ["part", "recording", "sample", "times", "values"]);
                test += 1;
            }
            None => assert_eq!(line["protocol"], "feeler-league"),
        }
    }
    // Each recording is tested in one of three folds.
    assert_eq!((train, test), (24, 12));
}

#[cfg(unix)]
#[test]
fn programs_that_fail_or_lie_are_marked() {
    let folder = folder("league-failing");
    grasps(&folder);
    let lying = format!("lying={}", judge("7", "0"));
    let entries = [
        "crashing=echo broken >&2; exit 3".to_string(),
        lying,
        "endless=yes | tr -d '\\n'".to_string(),
        "absent=no-such-program".to_string(),
        "talking=cat".to_string(),
        format!("good={}", judge("1", "0")),
    ];
    let mut arguments = vec!["league", ".", "--set", "grasps"];
    arguments.extend(entries.iter().flat_map(|entry| ["--entry", entry]));
    let ended = run(&folder, &arguments);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    for words in [
        "FAILED: crashing: ended (exit status: 3) after 0 of 4 answers: broken",
        "FAILED: lying: answer ",
        "probabilities of slip from 0 to 1, got \"{\\\"sample\\\":",
        "FAILED: endless: answer 1: expected an answer in JSON, got \"yyyy",
        "FAILED: absent: ended (exit status: 127)",
        "FAILED: talking: answer 1: expected an answer in JSON, got \"{\\\"protocol",
    ] {
        assert!(
            ended.stdout.contains(words),
            "no {words:?} in {}",
            ended.stdout
        );
    }
    assert_eq!(value(&folder, ["grasps", "auc", "good"]), 1.0);
    let page = document(&folder.join("league/league.html"));
    assert!(page.contains("crashing: ended"), "no reason on the page");
}

#[cfg(unix)]
#[test]
fn a_silent_program_is_ended() {
    let folder = folder("league-silent");
    grasps(&folder);
    // Its child keeps standard output open, and would write a file if it were not ended, too.
    let silent = "silent=(sleep 600; touch survived) & sleep 600";
    let ended = run(
        &folder,
        &[
            "league",
            ".",
            "--set",
            "grasps",
            "--entry",
            silent,
            "--time-limit=1",
        ],
    );
    assert_eq!(ended.status, Some(1), "{ended:?}");
    let words = "FAILED: silent: gave 0 of 4 answers within the limit of 1 s";
    assert!(ended.stdout.contains(words), "{}", ended.stdout);
    assert_eq!(value(&folder, ["grasps", "auc", "shear"]), 1.0);
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_ends_programs_and_leaves_no_files() {
    let folder = folder("league-interrupted");
    grasps(&folder);
    let sleeping = "sleeping=sleep 600 & echo $! > child; wait";
    let arguments = ["league", ".", "--set", "grasps", "--entry", sleeping];
    let mut command = feeler(&folder, &arguments);
    let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().expect("the program");
    let sleeper = loop {
        match fs::read_to_string(folder.join("child")) {
            Ok(id) if id.ends_with('\n') => break id.trim().to_owned(),
            _ => yield_now(),
        }
    };
    let ended = interrupt(child);
    assert_eq!(ended.status, Some(130), "{ended:?}");
    // It may take a moment to end; a zombie has ended.
    let stat = format!("/proc/{sleeper}/stat");
    while fs::read_to_string(&stat).is_ok_and(|stat| !stat.contains(") Z ")) {
        yield_now();
    }
    let left: Vec<_> = fs::read_dir(folder.join("league")).unwrap().collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn wrong_definitions_and_options_are_refused() {
    let folder = folder("league-refused");
    let league = |arguments: &[&str]| run(&folder, &[&["league", "."], arguments].concat());
    league(&[]).refused(&["no set found", "eflesh-slip", ".league.toml"]);
    pillar(&folder);
    league(&["--set", "nothing"]).refused(&["--set nothing", "eflesh-slip", "pillar"]);
    league(&["--entry", "noname"]).refused(&["a name and a command"]);
    league(&["--entry", "ridge=true"]).refused(&["--entry ridge", "no other entry"]);
    let path = folder.join("pillar/pillar.league.toml");
    let good = fs::read_to_string(&path).unwrap();
    for (from, to, words) in [
        ("version = 1", "version = 2", &["version", "expected 1"][..]),
        ("folds = 3", "folds = 1", &["split.folds", "2 to 100"]),
        (
            "name = \"pillar\"",
            "name = \"eflesh-slip\"",
            &["no other set has"],
        ),
        ("name = \"pillar\"", "name = \"a b\"", &["name", "letters"]),
        ("run-*", "../run-*", &["relative path without .."]),
        ("run-*", "r*n-*", &["at most one *"]),
        ("metric = \"rmse\"", "metric = \"median\"", &["rmse", "mae"]),
        ("factor = 0.001", "factor = 0.0", &["values.targets.factor"]),
        ("licence", "license", &["unknown field", "licence"]),
        (
            "[values]",
            "[slip]\nlabels = \"labels.csv\"\n[values]",
            &["slip, values", "one of them"],
        ),
    ] {
        fs::write(&path, good.replacen(from, to, 1)).unwrap();
        league(&[]).refused(words);
    }
    assert!(!folder.join("league").exists());
}

/// A set that cannot be read is marked, and the others are scored.
#[test]
fn an_unreadable_set_is_marked() {
    let folder = folder("league-unreadable");
    pillar(&folder);
    fs::create_dir(folder.join("eflesh-slip")).unwrap();
    let ended = run(&folder, &["league", "."]);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(
        ended.stdout.contains("FAILED: ") && ended.stdout.contains("LABELS.csv"),
        "{ended:?}"
    );
    assert!(
        ended.stdout.contains("not found: gelsight-slip"),
        "{ended:?}"
    );
    assert!(value(&folder, ["pillar", "rmse f_z", "ridge"]) < 0.02);
}

/// AUC of drag on all sequences does not depend on the folds: that of `feeler score-slip` (docs/slip.md).
#[test]
fn drag_on_real_magnetometers_in_the_league() {
    let Some(data) = recordings("eflesh-slip", "drag_on_real_magnetometers_in_the_league") else {
        return;
    };
    let folder = folder("league-real");
    let data = data.parent().unwrap().to_str().unwrap();
    run(&folder, &["league", data, "--set", "eflesh-slip"]).done();
    let auc = value(&folder, ["eflesh-slip", "auc", "drag"]);
    assert!((auc - 0.973).abs() < 0.0005, "{auc}");
}
