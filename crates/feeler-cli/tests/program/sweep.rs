//! `feeler sweep`.

use crate::program::{Ended, document, experiment, feeler, folder, rows, run, summary};
use std::collections::HashMap;
use std::fs;
use std::path::Path;

/// Arguments of a sweep of short trials of the reference experiment.
fn sweep<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec![
        "sweep",
        "cap-closing",
        "--sensing=direct",
        "--set=time_limit=4",
        "--trials=6",
        "--seed=5",
        "--vary=friction=uniform(0.7,1.3)",
        "--vary=cap.radius=normal(0.014,0.0001)",
    ];
    arguments.extend(more);
    arguments
}

#[test]
fn jobs_shards_and_interruptions_do_not_change_the_result() {
    let folder = folder("sweep-same");
    run(&folder, &sweep(&["--jobs=1", "-o=one"])).done();
    run(&folder, &sweep(&["--jobs=2", "-o=two"])).done();
    let whole = fs::read(folder.join("one/trials.csv")).unwrap();
    assert_eq!(whole, fs::read(folder.join("two/trials.csv")).unwrap());

    run(&folder, &sweep(&["--shard=1/2", "-o=a"])).done();
    run(&folder, &["sweep", "merge", "a", "-o", "c"]).refused(&["3 of 6", "shard 2/2"]);
    run(&folder, &sweep(&["--shard=2/2", "-o=b"])).done();
    run(&folder, &["sweep", "merge", "a", "a", "-o", "c"]).refused(&["twice"]);
    run(&folder, &["sweep", "merge", "a", "b", "-o", "c"]).done();
    assert_eq!(whole, fs::read(folder.join("c/trials.csv")).unwrap());

    // State after an interruption: two rows are complete, a third is truncated.
    let lines: Vec<_> = whole.split_inclusive(|&b| b == b'\n').collect();
    let torn = &lines[3][..lines[3].len() / 2];
    let left = [lines[0], lines[2], lines[1], torn].concat();
    fs::remove_file(folder.join("two/trials.csv")).unwrap();
    fs::write(folder.join("two/trials.csv.part"), left).unwrap();
    let said = run(&folder, &sweep(&["--resume", "-o=two"])).done();
    assert!(said.contains("4 trials in"), "{said}");
    assert_eq!(whole, fs::read(folder.join("two/trials.csv")).unwrap());

    let page = document(&folder.join("one/summary.html"));
    for word in [
        "Success rate against friction",
        "cap.radius",
        "feeler run --trial",
    ] {
        assert!(page.contains(word), "no {word:?}");
    }
    let others = sweep(&["--resume", "-o=two", "--set=task.screw.strokes=3"]);
    run(&folder, &others).refused(&["its experiment differs", "strokes"]);
    run(&folder, &sweep(&["-o=two"])).refused(&["already contains a sweep"]);
}

#[test]
fn ray_engine_refers_to_the_python_package() {
    let folder = folder("sweep-ray");
    run(&folder, &sweep(&["--engine=ray", "-o=one"])).refused(&["Python", "docs/sweeps.md"]);
    assert!(!folder.join("one").exists());
}

#[test]
fn trial_can_be_rerun_from_its_row_bit_for_bit() {
    let folder = folder("sweep-again");
    // Complete runs, so that every claim is measured.
    let arguments = sweep(&["-o=sweep", "--set=time_limit=60", "--trials=3"]);
    let arguments: Vec<_> = arguments
        .into_iter()
        .filter(|a| *a != "--trials=6")
        .collect();
    run(&folder, &arguments).done();
    let row = &rows(&folder.join("sweep/trials.csv"))[2];
    let ended = run(&folder, &["run", "--trial", "sweep", "2", "--out", "again"]);
    assert!(matches!(ended.status, Some(0 | 1)), "{ended:?}");
    let summary = summary(&folder.join("again"));
    let same = |column: &str, value: &serde_json::Value| {
        let number: Option<f64> = row[column].parse().ok();
        let bits = |v: Option<f64>| v.map(f64::to_bits);
        assert_eq!(bits(number), bits(value.as_f64()), "{column}");
    };
    same("sim_time", &summary["sim_time"]);
    same("cap_angle", &summary["cap_angle"]);
    assert_eq!(row["seed"], summary["seed"].to_string());
    let claims = summary["claims"].as_array().unwrap();
    assert_eq!(claims.len(), 11);
    for claim in claims {
        let id = claim["id"].as_str().unwrap();
        same(&format!("claim.{id}.value"), &claim["value"]);
        assert_eq!(row[&format!("claim.{id}")] == "1", claim["holds"] == true);
    }
    let strokes = summary["strokes"].as_array().unwrap();
    assert!(!strokes.is_empty());
    for stroke in strokes {
        for (name, value) in stroke.as_object().unwrap() {
            if name != "index" {
                same(&format!("stroke{}.{name}", stroke["index"]), value);
            }
        }
    }
    run(&folder, &["run", "--trial", "sweep", "3"]).refused(&["from 0 to 2"]);
    run(&folder, &["run", "--trial", "nowhere", "0"]).refused(&["folder of a sweep"]);
}

/// Runs a sweep with a control law. Returns the header and the rows of its table, and its output.
fn of_law(folder: &Path, name: &str, law: &str, more: &[&str]) -> (String, Rows, String) {
    let (law, out) = (format!("--set=control.law={law}"), format!("-o={name}"));
    let sweep = [
        "sweep",
        "cap-closing",
        "--sensing=direct",
        "--trials=3",
        "--seed=3",
        &law,
        &out,
    ];
    let said = run(folder, &[&sweep, more].concat()).done();
    let table = folder.join(name).join("trials.csv");
    let text = fs::read_to_string(&table).unwrap();
    let header = text.lines().next().unwrap().to_string();
    (header, rows(&table), said)
}

type Rows = Vec<HashMap<String, String>>;

/// The claims of any hand.
const FIVE: [&str; 5] = [
    "hand-follows-cap",
    "hand-path-is-curved",
    "hand-grip-is-steady",
    "hand-overloads-nothing",
    "hand-closes-cap",
];

#[test]
fn other_laws_are_judged_by_the_claims_of_any_hand() {
    let folder = folder("sweep-law");
    let (papers, _, said) = of_law(&folder, "papers", "tri-axial", &[]);
    assert!(said.contains("all its claims pass"), "{said}");
    let (header, rows, said) = of_law(&folder, "best", "best", &[]);
    assert_eq!(header, papers, "columns differ");
    assert!(said.contains("all five claims of any hand pass"), "{said}");
    for row in &rows {
        assert_eq!(row["outcome"], "done");
        let claims = |wanted: fn(&str) -> bool| -> Vec<&str> {
            let claims = row.iter().filter(|(name, _)| name.starts_with("claim."));
            let claims = claims.filter(|(name, _)| wanted(name));
            claims.map(|(_, value)| value.as_str()).collect()
        };
        let papers = claims(|name| !name.starts_with("claim.hand-"));
        assert!(papers.len() == 33 && papers.iter().all(|value| value.is_empty()));
        let hand = claims(|name| name.starts_with("claim.hand-"));
        assert!(hand.len() == 15 && hand.iter().all(|value| !value.is_empty()));
        let held = FIVE.iter().filter(|id| row[&format!("claim.{id}")] == "1");
        let held = held.count();
        assert_eq!(row["claims_held"], held.to_string());
        assert_eq!(row["success"] == "1", held == 5);
        // This law closes the cap and overloads nothing.
        for id in ["hand-closes-cap", "hand-overloads-nothing"] {
            assert_eq!(row[&format!("claim.{id}")], "1", "{id}");
        }
    }
    let page = document(&folder.join("best/summary.html"));
    assert!(page.contains("five claims of any hand") && !page.contains("no-damage"));

    // A cap that needs more than four strokes is not closed, even if the strokes are good.
    let open = ["--set=sim.object.cap.motion.thread.seat_angle=9.0"];
    let (_, rows, said) = of_law(&folder, "open", "best", &open);
    assert!(said.contains("0 of 3"), "{said}");
    assert!(
        rows.iter()
            .all(|row| row["outcome"] == "done" && row["claim.hand-closes-cap"] == "0")
    );

    // If the law differs from trial to trial, all trials are judged alike, and claims are counted only if they apply.
    let laws = [
        "--vary=control.law=choice(\"tri-axial\",\"best\")",
        "--seed=1",
    ];
    let arguments = [
        "sweep",
        "cap-closing",
        "--sensing=direct",
        "--trials=6",
        "-o=both",
    ];
    let said = run(&folder, &[&arguments[..], &laws].concat()).done();
    assert!(said.contains("five claims of any hand"), "{said}");
    let rows = self::rows(&folder.join("both/trials.csv"));
    let held = |law: &str| -> Vec<bool> {
        let rows = rows.iter().filter(|row| row["control.law"].contains(law));
        rows.map(|row| row["claim.no-damage"].is_empty()).collect()
    };
    let (papers, best) = (held("tri-axial"), held("best"));
    assert!(!papers.is_empty() && !best.is_empty(), "{rows:?}");
    assert!(papers.iter().all(|empty| !empty) && best.iter().all(|empty| *empty));
    let page = document(&folder.join("both/summary.html"));
    let of = format!("no-damage</td><td class=\"number\">{}</td>", papers.len());
    assert!(page.contains(&of), "not of {}", papers.len());
    assert!(page.contains("hand-closes-cap</td><td class=\"number\">6</td>"));

    // With too few strokes for these claims, only the final state of the cap is judged.
    let two = ["--set=task.screw.strokes=2"];
    let (header, _, said) = of_law(&folder, "two", "best", &two);
    assert!(said.contains("the cap is closed"), "{said}");
    assert!(!header.contains("claim.hand-"));
}

#[test]
fn invalid_variations_are_refused_before_the_first_trial() {
    let folder = folder("sweep-refused");
    for (vary, words) in [
        ("friction", ["NAME=DISTRIBUTION", ""]),
        ("friction=uniform(1", ["bracket", ""]),
        ("friction=uniform(1,0.5)", ["must not exceed", ""]),
        ("friction=gauss(1,2)", ["gauss", "normal(mean,sd)"]),
        (
            "slip_treshold=uniform(1,2)",
            ["no parameter", "control.slip_threshold"],
        ),
        ("elements=uniform(1,2)", ["could mean any of", "rings"]),
        (
            "cap.radius=uniform(-1,0.014)",
            ["cylinder.radius", "expected"],
        ),
        ("sensing=uniform(1,2)", ["not a number", "choice"]),
        ("seed=uniform(1,2)", ["--seed", ""]),
    ] {
        let vary = format!("--vary={vary}");
        run(&folder, &["sweep", "cap-closing", &vary, "-o=s"]).refused(&words);
        assert!(!folder.join("s").exists(), "{vary}");
    }
    let twice = sweep(&["--vary=static_friction=uniform(1,2)", "-o=s"]);
    run(&folder, &twice).refused(&["sets the same key as friction"]);
}

#[test]
fn invalid_trials_are_rows_and_the_sweep_continues() {
    let folder = folder("sweep-wrong");
    let arguments = sweep(&["--vary=touch_force=normal(0.1,0.2)", "--trials=12", "-o=s"]);
    let arguments: Vec<_> = arguments
        .into_iter()
        .filter(|a| *a != "--trials=6")
        .collect();
    run(&folder, &arguments).done();
    let rows = rows(&folder.join("s/trials.csv"));
    assert_eq!(rows.len(), 12);
    let invalid = |row: &&HashMap<String, String>| row["outcome"] == "invalid";
    let invalid: Vec<_> = rows.iter().filter(invalid).collect();
    assert!(!invalid.is_empty() && invalid.len() < 12);
    for row in invalid {
        assert!(row["reason"].contains("control.touch_force"), "{row:?}");
        assert!(row["touch_force"].parse::<f64>().unwrap() <= 0.0);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn full_disk_is_reported_and_finished_trials_are_kept() {
    let folder = folder("sweep-full");
    let sweep = |more: &[&'static str]| {
        let mut arguments = sweep(more);
        arguments.retain(|argument| !argument.starts_with("--trials"));
        arguments.push("--trials=40");
        arguments
    };
    run(&folder, &sweep(&["--jobs=1", "-o=whole"])).done();
    let whole = fs::read(folder.join("whole/trials.csv")).unwrap();

    // The file size limit, in blocks of 512 bytes, is reached within a row.
    let blocks = (whole.len() / 2 / 512).to_string();
    let limited = "trap '' XFSZ; ulimit -f $1; shift; exec \"$@\"";
    let mut command = std::process::Command::new("sh");
    command.args(["-c", limited, "sh", &blocks, env!("CARGO_BIN_EXE_feeler")]);
    command.args(sweep(&["--jobs=1", "-o=s"]));
    let ended = Ended::of(command.current_dir(&folder).output().unwrap());
    let said = ended.refused(&["trials.csv.part", "File too large", "--resume"]);
    let part = fs::read_to_string(folder.join("s/trials.csv.part")).unwrap();
    let kept = part.matches('\n').count() - 1;
    assert!(
        kept >= 1 && !part.ends_with('\n'),
        "{kept} rows and no truncated one"
    );
    assert!(
        said.contains(&format!("the {kept} finished trials are kept")),
        "{said}"
    );

    run(&folder, &sweep(&["--resume", "-o=s"])).done();
    assert_eq!(whole, fs::read(folder.join("s/trials.csv")).unwrap());
}

#[cfg(unix)]
#[test]
fn interrupted_sweep_keeps_its_rows() {
    let folder = folder("sweep-stopped");
    experiment(&folder, "time_limit = 60.0", "time_limit = 5.0");
    let arguments = [
        "sweep",
        "my.toml",
        "--sensing=direct",
        "--trials=100000",
        "-o=s",
    ];
    let mut command = feeler(&folder, &arguments);
    command
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped());
    let mut child = command.spawn().unwrap();
    let part = folder.join("s/trials.csv.part");
    let lines = || fs::read_to_string(&part).map_or(0, |text| text.lines().count());
    while lines() < 4 {
        assert!(
            child.try_wait().unwrap().is_none(),
            "the program ended by itself"
        );
        std::thread::yield_now();
    }
    let id = child.id().to_string();
    assert!(
        std::process::Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    let ended = Ended::of(child.wait_with_output().unwrap());
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("--resume -o s"), "{ended:?}");
    let kept = fs::read_to_string(&part).unwrap();
    assert!(kept.ends_with('\n') && kept.lines().count() >= 4);
}
