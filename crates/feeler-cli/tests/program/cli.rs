//! Basic commands of the program.

use crate::program::{Ended, experiment, feeler, folder, run, summary, whole_run};
use std::fs;
use std::process::Stdio;

#[test]
fn usage_is_printed_without_arguments() {
    let folder = folder("help");
    run(&folder, &[]).refused(&["Usage: feeler", "Examples:", "feeler run cap-closing"]);
    let help = run(&folder, &["--help"]).done();
    for word in ["Examples:", "Exit status", "calibrate", "report"] {
        assert!(help.contains(word), "{help}");
    }
    for command in ["run", "list", "check", "report", "replay", "calibrate"] {
        let help = run(&folder, &[command, "--help"]).done();
        assert!(help.contains("Usage: feeler"), "{help}");
    }
}

#[test]
fn experiments_are_listed_and_checked() {
    let folder = folder("check");
    let list = run(&folder, &["list"]).done();
    assert!(
        list.starts_with("cap-closing ") && list.contains("bottle cap"),
        "{list}"
    );
    let good = run(&folder, &["check", "cap-closing"]).done();
    assert!(
        good.contains("good") && good.contains("41 elements"),
        "{good}"
    );
    experiment(&folder, "strokes = 4", "strokes = 3");
    let good = run(&folder, &["check", "my.toml"]).done();
    assert!(good.contains("3 strokes"), "{good}");
    let set = ["check", "my.toml", "--set", "task.screw.strokes=2"];
    assert!(run(&folder, &set).done().contains("2 strokes"));
}

#[test]
fn run_writes_recording_report_and_summary() {
    let folder = folder("run");
    let run_folder = whole_run(&folder);
    let page = fs::read_to_string(run_folder.join("report.html")).unwrap();
    assert!(page.ends_with("</html>\n") || page.ends_with("</html>"));
    assert!(!page.contains("INCOMPLETE"));
    let first = summary(&run_folder);
    assert_eq!(first["seed"], 0);
    assert_eq!(first["strokes"].as_array().unwrap().len(), 4);

    // Make the report again from the recording alone.
    for file in ["report.html", "summary.json"] {
        fs::remove_file(run_folder.join(file)).unwrap();
    }
    let said = run(&folder, &["report", "run"]).done();
    assert!(said.contains("run/report.html"), "{said}");
    assert_eq!(summary(&run_folder), first);
    assert_eq!(
        fs::read_to_string(run_folder.join("report.html")).unwrap(),
        page
    );
    let by_file = run(&folder, &["report", "run/recording.mcap"]).done();
    assert_eq!(by_file, said);
}

#[test]
fn command_line_options_change_the_run() {
    let folder = folder("varied");
    let arguments = [
        "run",
        "cap-closing",
        "--sensing=direct",
        "--seed=7",
        "--set=task.screw.strokes=1",
        "--set=sensor.fingertip.camera.centre_px=[319.0, 240.0]",
        "--set=hand.finger.1.joint_speed_limit.0=1.5",
    ];
    // Without --out, every run gets a new folder.
    for name in ["", "-2", "-3"] {
        let said = run(&folder, &arguments).done();
        let path = format!("runs/cap-closing-direct-seed7{name}");
        assert!(said.contains(&format!("{path}/report.html")), "{said}");
        let summary = summary(&folder.join(path));
        assert_eq!(summary["seed"], 7);
        assert_eq!(summary["strokes"].as_array().unwrap().len(), 1);
    }
}

#[test]
fn speed_does_not_change_the_run() {
    let folder = folder("speed");
    let start = [
        "run",
        "cap-closing",
        "--sensing=direct",
        "--set=task.screw.strokes=1",
    ];
    let digest = |arguments: &[&str], name: &str| {
        let out = format!("--out={name}");
        run(&folder, &[&start, arguments, &[&out]].concat()).done();
        let summary = summary(&folder.join(name));
        assert_eq!(summary["state"], "done", "{summary}");
        summary["digest"].clone()
    };
    let fast = digest(&[], "fast");
    assert_eq!(digest(&["--speed=100"], "slow"), fast);
    assert_eq!(digest(&["--speed=max"], "max"), fast);
    for speed in ["--speed=0", "--speed=-1", "--speed=fast"] {
        run(&folder, &["run", "cap-closing", speed]).refused(&["--speed", "or max"]);
    }
}

/// The tests have no terminal. A build without the view refuses the flag, too.
#[test]
fn top_is_refused_without_a_terminal() {
    let folder = folder("top");
    run(&folder, &["run", "cap-closing", "--top"]).refused(&["--top", "terminal"]);
    assert!(!folder.join("runs").exists());
}

#[test]
fn unfinished_task_ends_with_status_1_and_a_reason() {
    let folder = folder("not-done");
    let start = ["run", "cap-closing", "--sensing=direct", "--out"];
    let ended = run(
        &folder,
        &[&start[..], &["a", "--set=time_limit=1"]].concat(),
    );
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("time limit"), "{ended:?}");
    let limit = "--set=task.screw.search_limit=0.001";
    let ended = run(&folder, &[&start[..], &["b", limit]].concat());
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert!(ended.stdout.contains("stopped"), "{ended:?}");
    assert!(folder.join("b/report.html").exists());
}

#[test]
fn a_calibration_can_be_made_and_used() {
    let folder = folder("calibrate");
    experiment(&folder, "elements = 12", "elements = 11");
    let calibration = [
        "--force",
        "-o",
        "reference-fingertip.coupled.calibration.toml",
    ];
    run(&folder, &["check", "my.toml"]).refused(&[
        "elements",
        "= 11 in the configuration, 12 in the calibration",
    ]);
    let arguments = [&["calibrate", "--simulated", "my.toml"][..], &calibration].concat();
    let said = run(&folder, &arguments).done();
    assert!(said.contains("reference-fingertip"), "{said}");
    assert!(
        folder
            .join("reference-fingertip.coupled.calibration.html")
            .exists()
    );
    assert!(
        run(&folder, &["check", "my.toml"])
            .done()
            .contains("40 elements")
    );
}

/// The reader of a pipe closes it before anything is written.
#[test]
fn closed_pipe_does_not_affect_output_files() {
    let folder = folder("pipe");
    let run = ["run", "cap-closing", "--sensing=direct", "--out=run"];
    let commands: [&[&str]; 5] = [
        &run,
        &["report", "run"],
        &["list"],
        &["check", "cap-closing"],
        &["--help"],
    ];
    for arguments in commands {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = feeler(&folder, arguments);
        let output = command.stdout(writer).stderr(Stdio::piped()).output();
        Ended::of(output.unwrap()).done();
    }
    assert!(folder.join("run/report.html").exists());
    assert!(folder.join("run/summary.json").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_is_an_error() {
    let folder = folder("full");
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = feeler(&folder, &["list"]).stdout(full).output().unwrap();
    Ended::of(output).refused(&["No space left"]);
}
