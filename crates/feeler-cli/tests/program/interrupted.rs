//! An interrupted or killed run leaves a readable recording.

#![cfg(unix)]

use crate::program::{Ended, experiment, feeler, folder, run, summary};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::yield_now;

/// Starts a run that takes hours, and waits until its recording has at least `bytes` bytes.
fn start_long_run(folder: &Path, bytes: u64) -> Child {
    // Strokes continue forever: the cap never reaches its seat.
    experiment(folder, "seat_angle = 0.59", "seat_angle = 1e6");
    let arguments = [
        "run",
        "my.toml",
        "--sensing=direct",
        "--set=task.screw.strokes=1000",
        "--set=time_limit=90000",
        "--out=run",
    ];
    let mut command = feeler(folder, &arguments);
    let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program");
    let recording = folder.join("run/recording.mcap");
    let written = || fs::metadata(&recording).map_or(0, |m| m.len());
    while written() < bytes {
        let ended = child.try_wait().expect("its state");
        assert!(ended.is_none(), "the program ended by itself: {ended:?}");
        yield_now();
    }
    child
}

fn send(signal: &str, child: &Child) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([signal, &id]).status();
    assert!(sent.expect("the kill command").success());
}

#[test]
fn interrupted_run_is_closed_and_reported() {
    for signal in ["-INT", "-TERM"] {
        let folder = folder(&format!("interrupted{signal}"));
        let child = start_long_run(&folder, 300_000);
        send(signal, &child);
        let ended = Ended::of(child.wait_with_output().unwrap());
        assert_eq!(ended.status, Some(1), "{ended:?}");
        assert!(ended.stdout.contains("interrupted"), "{ended:?}");
        let page = fs::read_to_string(folder.join("run/report.html")).unwrap();
        assert!(page.contains("<title>INTERRUPTED: ") && page.contains("INTERRUPTED at t = "));
        assert!(
            page.contains("not measured"),
            "claims that the run did not reach"
        );
        let made = summary(&folder.join("run"));
        assert_eq!(made["state"], "interrupted", "{made}");
        assert!(made["reason"].as_str().unwrap().contains("Ctrl-C"));
        // The recording is complete: it gives the same report again.
        run(&folder, &["report", "run"]).done();
        assert_eq!(summary(&folder.join("run")), made);
    }
}

#[test]
fn killed_run_is_readable_up_to_its_last_chunk() {
    let folder = folder("killed");
    let mut child = start_long_run(&folder, 1_000_000);
    send("-KILL", &child);
    child.wait().unwrap();
    assert!(!folder.join("run/report.html").exists());
    let ended = run(&folder, &["report", "run"]);
    ended.refused(&["incomplete", "up to", "the report covers the run"]);
    let page = fs::read_to_string(folder.join("run/report.html")).unwrap();
    assert!(page.contains("INCOMPLETE: readable up to"));
}

/// Ctrl-C keeps every finished grasp with its label, and reports that there are fewer than requested.
#[test]
fn interrupted_grasps_keep_their_labels() {
    let folder = folder("simulate-grasps-interrupted");
    let arguments = ["simulate-grasps", "--count=100000", "--out=grasps"];
    let mut command = feeler(&folder, &arguments);
    let mut child = command.stdout(Stdio::piped()).spawn().expect("the program");
    let second = folder.join("grasps/recordings/00001.toml");
    while !second.exists() {
        let ended = child.try_wait().expect("its state");
        assert!(ended.is_none(), "the program ended by itself: {ended:?}");
        yield_now();
    }
    send("-INT", &child);
    let ended = Ended::of(child.wait_with_output().unwrap());
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("interrupted after"), "{ended:?}");
    assert!(!folder.join("grasps/labels.csv").exists());
    let labels = fs::read_to_string(folder.join("grasps/labels.csv.part")).expect("labels");
    let labelled: Vec<_> = labels.lines().skip(1).map(|l| &l[..5]).collect();
    let recorded = fs::read_dir(folder.join("grasps/recordings")).expect("recordings");
    let layouts = recorded.filter(|entry| {
        let path = entry.as_ref().expect("an entry").path();
        path.extension().is_some_and(|end| end == "toml")
    });
    assert_eq!(layouts.count(), labelled.len());
    assert!(labelled.contains(&"00000"), "{labelled:?}");
}
