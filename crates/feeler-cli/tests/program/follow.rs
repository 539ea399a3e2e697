//! `feeler follow`: requests on standard input, answers on standard output.

use crate::program::{Ended, feeler, folder, run};
use feeler_record::Recording;
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

#[test]
fn a_simulated_hand_answers_each_line_and_follows_velocities() {
    let folder = folder("follow-simulated");
    let arguments = [
        "follow",
        "cap-closing",
        "--simulated",
        "--sensing=direct",
        "--out=run",
    ];
    let mut child = feeler(&folder, &arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program");
    let mut input = child.stdin.take().expect("its input");
    let mut answers = BufReader::new(child.stdout.take().expect("its output")).lines();
    let mut next = || -> Value {
        let line = answers.next().expect("an answer").expect("text");
        serde_json::from_str(&line).expect("JSON")
    };
    let described = next();
    assert_eq!(
        (&described["protocol"], &described["lifetime"]),
        (&json!(1), &json!(0.2))
    );
    assert_eq!(described["fingers"][1]["elements"], 41);
    let mut ask = |line: &str| {
        writeln!(input, "{line}").expect("the program");
        next()
    };
    let mut first = ask("{}");
    while first["waiting"] == true {
        first = ask("{}");
    }
    let speed = |answer: &Value| {
        answer["fingers"][0]["command"][1]
            .as_f64()
            .expect("a number")
    };
    assert_eq!(speed(&first), 0.0);
    let moved = ask(r#"{"velocity": [[0, -0.05, 0], [0, 0, 0]]}"#);
    assert!((speed(&moved) + 0.05).abs() < 1e-6, "{moved}");
    assert!(moved["time"].as_f64() > first["time"].as_f64(), "{moved}");
    assert_eq!(
        moved["fingers"][0]["force"].as_array().map(Vec::len),
        Some(41)
    );
    let refused = ask(r#"{"velocity": [[0, 1e999, 0], [0, 0, 0]]}"#);
    assert!(
        refused["error"]
            .as_str()
            .expect("a reason")
            .contains("out of range")
    );
    // The request expires without another one.
    let mut later = ask("{}");
    while later["time"].as_f64() < moved["time"].as_f64().map(|time| time + 0.25) {
        later = ask("{}");
    }
    assert_eq!(speed(&later), 0.0);
    drop(input);
    let ended = Ended::of(child.wait_with_output().expect("its end"));
    assert_eq!(ended.status, Some(0), "{ended:?}");
    let recording = Recording::read(folder.join("run/recording.mcap")).expect("a recording");
    assert!(recording.complete, "{:?}", recording.problem);
    // The report makes no claims about a task that was not executed.
    assert!(recording.facts.followed_requests());
    let summary = fs::read_to_string(folder.join("run/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_str(&summary).expect("JSON");
    assert_eq!(summary["claims"], json!([]), "{summary}");
    assert_eq!(summary["hand_claims"], Value::Null, "{summary}");
    assert_eq!(summary["success"]["criterion"], "the task was completed");
}

#[test]
fn a_description_needs_no_rig_and_options_without_effect_are_refused() {
    let folder = folder("follow-described");
    let described = run(&folder, &["follow", "grip", "--describe", "--lifetime=0.5"]).done();
    let described: Value = serde_json::from_str(&described).expect("JSON");
    assert_eq!(
        (&described["experiment"], &described["lifetime"]),
        (&json!("grip"), &json!(0.5))
    );
    let refused = |option: &str| {
        let arguments = ["follow", "grip", "--simulated", option];
        run(&folder, &arguments).refused(&["has no effect with --simulated"]);
    };
    refused("--listen=tcp/127.0.0.1:1");
    refused("--connect=tcp/127.0.0.1:1");
    run(&folder, &["follow", "grip", "--lifetime=9"]).refused(&["expected 0.01 to 5 s"]);
}
